/* urdfdom's messages go to a handler of the whole process: ours stands in for it only while we read, takes only our own
   thread's messages, and leaves it as it was. */
#include <atomic>
#include <check.h>
#include <console_bridge/console.h>
#include <cstring>
#include <string>
#include <thread>
#include <vector>

extern "C" {
#include "urdf/robot.h"
}

namespace {

const char good[] = "<robot name='r'><link name='a'/><link name='b'/><joint name='j' type='fixed'><parent link='a'/>"
		    "<child link='b'/></joint></robot>";
/* what urdfdom alone refuses */
const char bad[] = "<robot name='r' version='2.0'><link name='a'/><link name='b'/><joint name='j' type='fixed'><parent link='a'/>"
		   "<child link='b'/></joint></robot>";

/* What the application had installed. */
class Mine : public console_bridge::OutputHandler
{
public:
	std::atomic<long> mine{0}, others{0};

	void log(const std::string &text, console_bridge::LogLevel, const char *, int) override
	{
		(text == "mine" ? mine : others)++;
	}
};

rneagen_code read(const char *xml, rneagen_error *e)
{
	struct arena a;
	struct robot r;

	*e = {};
	arena_init(&a, nullptr);
	robot_read(&r, xml, std::strlen(xml), "file", &a, e);
	arena_free(&a);
	return e->code;
}

} // namespace

START_TEST(handler_is_left_as_it_was)
{
	rneagen_error e;
	Mine mine;

	for (console_bridge::OutputHandler *handler : {static_cast<console_bridge::OutputHandler *>(nullptr),
		     static_cast<console_bridge::OutputHandler *>(&mine)}) {
		console_bridge::useOutputHandler(handler);
		ck_assert_int_eq(read(good, &e), RNEAGEN_OK);
		ck_assert(console_bridge::getOutputHandler() == handler);
		ck_assert_int_eq(read(bad, &e), RNEAGEN_URDF);
		ck_assert(console_bridge::getOutputHandler() == handler);
	}
	CONSOLE_BRIDGE_logError("mine");
	ck_assert_int_eq(mine.mine, 1);
	ck_assert_int_eq(mine.others, 0);
}
END_TEST

/* Two threads read, each its own errors; two more log all the while, and have begun before: what they say arrives, and
   nothing else. */
START_TEST(threads_keep_their_messages)
{
	const int rounds = 300;
	std::atomic<long> wrong{0}, sent{0};
	std::atomic<int> readers{2}, loggers{0};
	std::vector<std::thread> threads;
	Mine mine;

	console_bridge::useOutputHandler(&mine);
	for (int t = 0; t < 2; t++)
		threads.emplace_back([&, t] {
			while (loggers < 2)
				std::this_thread::yield();
			for (int i = 0; i < rounds; i++) {
				rneagen_error e;
				const bool refused = read((i + t) % 2 ? bad : good, &e) != RNEAGEN_OK;
				const bool said = std::strstr(e.message,
					"file:1: refused by urdfdom: Invalid 'version' specified") != nullptr;

				wrong += refused != ((i + t) % 2 == 1) || said != refused;
			}
			readers--;
		});
	for (int t = 0; t < 2; t++)
		threads.emplace_back([&] {
			CONSOLE_BRIDGE_logError("mine");
			for (sent++, loggers++; readers; sent++)
				CONSOLE_BRIDGE_logError("mine");
		});
	for (std::thread &t : threads)
		t.join();
	ck_assert_int_eq(wrong, 0);
	ck_assert_int_ge(sent, 2);
	ck_assert_int_eq(mine.mine, sent);
	ck_assert_int_eq(mine.others, 0);
	ck_assert(console_bridge::getOutputHandler() == &mine);
}
END_TEST

int main()
{
	Suite *suite = suite_create("console");
	TCase *tc = tcase_create("handler");
	SRunner *runner = srunner_create(suite);

	tcase_set_timeout(tc, 60);
	tcase_add_test(tc, handler_is_left_as_it_was);
	tcase_add_test(tc, threads_keep_their_messages);
	suite_add_tcase(suite, tc);
	srunner_run_all(runner, CK_NORMAL);
	const int failed = srunner_ntests_failed(runner);
	srunner_free(runner);
	return failed != 0;
}
