#include <atomic>
#include <console_bridge/console.h>
#include <exception>
#include <mutex>
#include <new>
#include <string>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

extern "C" {
#include "urdf/urdf_shim.h"
}

namespace {

using console_bridge::LogLevel;
using console_bridge::OutputHandler;

thread_local std::string *errors; /* where this thread's messages go while it parses; else null */

/* urdfdom says what is wrong through console_bridge, whose handler belongs to the whole process. This one keeps the
   errors of threads that parse and hands every other message to the handler that was there before. */
class Router : public OutputHandler {
public:
	std::atomic<OutputHandler *> before{nullptr};

	void log(const std::string &text, LogLevel level, const char *file, int line) override
	{
		OutputHandler *other = before;

		if (!errors && other)
			other->log(text, level, file, line);
		if (errors && level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR)
			*errors += (errors->empty() ? "" : "; ") + text;
	}
};

/* The router is in place while at least one thread parses. It is never freed: console_bridge may keep its address. */
class Capture {
public:
	explicit Capture(std::string *sink)
	{
		const std::lock_guard<std::mutex> guard(lock());
		OutputHandler *now = console_bridge::getOutputHandler();

		if (users()++ == 0 && now != &router()) {
			router().before = now;
			console_bridge::useOutputHandler(&router());
		}
		errors = sink;
	}

	~Capture()
	{
		const std::lock_guard<std::mutex> guard(lock());

		errors = nullptr;
		if (--users() == 0 && console_bridge::getOutputHandler() == &router())
			console_bridge::useOutputHandler(router().before);
	}

	Capture(const Capture &) = delete;
	Capture &operator=(const Capture &) = delete;

private:
	static Router &router()
	{
		static Router *r = new Router;
		return *r;
	}

	static std::mutex &lock()
	{
		static std::mutex m;
		return m;
	}

	static int &users()
	{
		static int n;
		return n;
	}
};

/* What was read of the decimal stays, unless urdfdom has another number. */
void put(struct within &out, double x)
{
	if (out.x != static_cast<real>(x))
		out = within_exact(x);
}

void put(struct within out[3], const urdf::Vector3 &v)
{
	put(out[0], v.x);
	put(out[1], v.y);
	put(out[2], v.z);
}

void fill_link(struct link &l, const urdf::Link &from)
{
	if (!from.inertial)
		return;
	const urdf::Inertial &i = *from.inertial;
	const double inertia[] = {i.ixx, i.ixy, i.ixz, i.iyy, i.iyz, i.izz};

	l.has_inertial = 1;
	put(l.mass, i.mass);
	put(l.com, i.origin.position);
	for (int k = 0; k < 6; k++)
		put(l.inertia[k], inertia[k]);
}

void fill_joint(struct joint &j, const urdf::Joint &from)
{
	put(j.xyz, from.parent_to_joint_origin_transform.position);
	put(j.axis, from.axis);
	if (from.limits && (j.type == JOINT_REVOLUTE || j.type == JOINT_PRISMATIC)) {
		j.has_limits = 1;
		j.lower = from.limits->lower;
		j.upper = from.limits->upper;
	}
	if (from.limits && (j.has_limits || j.type == JOINT_CONTINUOUS)) {
		j.has_rates = 1;
		j.velocity = from.limits->velocity;
		j.effort = from.limits->effort;
	}
	if (from.dynamics) {
		j.has_dynamics = 1;
		put(j.damping, from.dynamics->damping);
		put(j.friction, from.dynamics->friction);
	}
	if (from.mimic) {
		put(j.multiplier, from.mimic->multiplier);
		put(j.offset, from.mimic->offset);
	}
}

rneagen_code fill_robot(const urdf::ModelInterface &model, const struct outline *o, const struct diagnostic *p)
{
	struct robot *r = p->robot;

	for (int i = 0; i < r->link_count; i++) {
		const auto from = model.getLink(r->links[i].name);

		if (!from)
			return diagnostic_error(p, RNEAGEN_URDF, o->links[i].id.line, "link '%s' is lost in urdfdom; rename it",
				r->links[i].name);
		fill_link(r->links[i], *from);
	}
	for (int i = 0; i < r->joint_count; i++) {
		const auto from = model.getJoint(r->joints[i].name);

		if (!from)
			return diagnostic_error(p, RNEAGEN_URDF, o->joints[i].id.line, "joint '%s' is lost in urdfdom; rename it",
				r->joints[i].name);
		fill_joint(r->joints[i], *from);
	}
	return RNEAGEN_OK;
}

/* The joint or link that urdfdom names, as "joint [elbow]", or the robot. */
long line_of(const std::string &said, const struct outline *o)
{
	for (size_t i = 0; i < o->joint_count; i++)
		if (said.find("oint [" + std::string(o->joints[i].id.name) + "]") != std::string::npos)
			return o->joints[i].id.line;
	for (size_t i = 0; i < o->link_count; i++)
		if (said.find("ink [" + std::string(o->links[i].id.name) + "]") != std::string::npos)
			return o->links[i].id.line;
	return o->line;
}

rneagen_code refuse(const std::string &said, const struct outline *o, const struct diagnostic *p)
{
	bool is_version = false;

	for (const char *words : {"'version'", "ersion attribute", "ersion number"})
		is_version |= said.find(words) != std::string::npos;
	return diagnostic_error(p, RNEAGEN_URDF, line_of(said, o), "refused by urdfdom: %s; %s", said.c_str(),
		is_version ? "write version=\"1.0\", or leave it out" : "correct it, or remove what it names");
}

rneagen_code parse(const struct outline *o, const struct diagnostic *p)
{
	std::string said;
	urdf::ModelInterfaceSharedPtr model;
	{
		const Capture capture(&said);

		model = urdf::parseURDF(text_string(&o->urdf));
	}
	if (!model || !said.empty())
		return refuse(said.empty() ? "no reason given" : said, o, p);
	return fill_robot(*model, o, p);
}

} // namespace

extern "C" enum rneagen_code urdf_read(const struct outline *o, const struct diagnostic *p)
{
	try {
		return parse(o, p);
	} catch (const std::bad_alloc &) {
		return error_memory(p->error);
	} catch (const std::exception &x) {
		return diagnostic_error(p, RNEAGEN_URDF, o->line, "refused by urdfdom: %s; correct what it names", x.what());
	} catch (...) {
		return diagnostic_error(p, RNEAGEN_URDF, o->line,
			"refused by urdfdom without a reason; does check_urdf read the file?");
	}
}
