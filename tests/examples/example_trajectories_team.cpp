/* The step of examples/trajectories/trajectories_step.h by as many threads as a block on the GPU has, held against the
   same by one alone: every bit must agree, for each element is made by one thread, in one order. Under the thread
   sanitizer a wait that is missing is found, too. */
#include "trajectories_step.h"
#include <cstdio>
#include <cstring>
#include <pthread.h>
#include <random>
#include <thread>

enum { COUNT = 3, STEPS = 3, THREADS = 128, SEED = 5 };
struct crew {
	static constexpr int threads = THREADS;
	int thread;
	pthread_barrier_t *barrier;

	void wait() const
	{
		pthread_barrier_wait(barrier);
	}
};

struct memory {
	std::vector<trajectory<double>> all;
	std::vector<double> arrays[ARRAYS], history;
	batch<double> b;
};

/* Any numbers do: torques and derivatives are drawn, smaller from step to step, so that some trials are kept. */
static void draw(memory &m, int round)
{
	std::mt19937 random((unsigned)(SEED + round));
	std::uniform_real_distribution<double> unit(-1, 1);

	for (int i = 0; i < ARRAYS; i++)
		for (double &x : m.arrays[i])
			x = (i < ARRAY_TAU ? 3 : 10) * unit(random) * (i == ARRAY_TAU && round == 1 ? 0.5 : 1);
}

static void prepare(memory &m, const tables<double> &t)
{
	m.all = random_trajectories(COUNT);
	bend(m.all);
	m.history.resize(COUNT * STEPS);
	m.b = {COUNT, &t, m.all.data(), {}, m.history.data()};
	for (int i = 0; i < ARRAYS; i++) {
		m.arrays[i].resize(HEIGHTS[i] * COUNT * NODES);
		m.b.array[i] = m.arrays[i].data();
	}
}

static void step_by_crew(const memory &m, size_t k, int round, scratch<double> &s)
{
	std::vector<std::thread> threads;
	pthread_barrier_t barrier;

	pthread_barrier_init(&barrier, NULL, THREADS);
	for (int i = 0; i < THREADS; i++)
		threads.emplace_back([&, i] { step(m.b, k, round, s, crew{i, &barrier}); });
	for (std::thread &thread : threads)
		thread.join();
	pthread_barrier_destroy(&barrier);
}

int main()
{
	const tables<double> t = make_tables();
	std::vector<scratch<double>> s(2);
	memory one, many;
	int kept = 0;

	prepare(one, t);
	prepare(many, t);
	for (int round = 0; round < STEPS; round++) {
		draw(one, round);
		draw(many, round);
		for (size_t k = 0; k < COUNT; k++) {
			step(one.b, k, round, s[0], team<1>{0});
			step_by_crew(many, k, round, s[1]);
			kept += s[0].kept;
			if (memcmp(&one.all[k], &many.all[k], sizeof one.all[k]) || one.history != many.history) {
				fprintf(stderr,
					"trajectory %zu, step %d, seed %d: %d threads do not do what one does\n", k,
					round, SEED, THREADS);
				return 1;
			}
		}
	}
	printf("%d steps, %d of them kept: %d threads do what one does, seed %d\n", COUNT * STEPS, kept, THREADS, SEED);
	return kept == 0 || kept == COUNT * STEPS;
}
