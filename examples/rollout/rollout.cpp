/* rollout: a Panda follows a moving goal, by sampling (model predictive path integral control, Williams, Drews,
   Goldfain, Rehg and Theodorou 2016). A hundred times a second, 16384 rollouts of 64 steps start from where the arm is.
   Each commands the plan's speeds with noise of its own to the servos of the joints; the next plan is the mean of what
   they command, weighted by exp(-cost / LAMBDA). The arm is simulated beside it in finer steps. rollout --help lists
   the options.

   Every run also checks the noise's generator and the limits of the joints, and lets the arm swing freely: what its
   energy is off falls with the step as the integrators' orders say. rollout.gp plots what --trace writes. */
#include "rollout.h"
#include "../common.h"
#include "../philox.h"
#include <cmath>
#include <memory>

const char *const PROGRAM = "rollout";

struct options {
	settings s;
	double seconds;
	bool cpu, check, csv, help;
	const char *trace;
};

static const char *const USAGE =
	"usage: rollout [options]\n"
	"  --rollouts N          how many at once (default 16384)\n"
	"  --steps N             of 0.01 s each (default 64)\n"
	"  --integrator euler|rk4\n"
	"                        semi-implicit Euler (default), or Runge and Kutta's of the fourth order\n"
	"  --precision f32|f64   of the rollouts (default f32)\n"
	"  --seconds S           how long the arm is controlled (default 4)\n"
	"  --seed N              of the noise (default 1)\n"
	"  --cpu                 on the host, by all threads of OpenMP, even where there is a GPU\n"
	"  --check               one tick on the GPU and on the host: are the costs the same?\n"
	"  --trace FILE.csv      write the tracking error over time\n"
	"  --csv                 print a line of figures alone\n"
	"  --help\n"
	"exit status: 0 done, 1 something is wrong or failed, 2 the command line is\n";

/* The known answers that the paper's authors publish for philox4x32, 10 rounds. */
static int check_philox()
{
	static const struct {
		philox counter;
		uint64_t key;
		philox answer;
	} known[] = {
		{{{0, 0, 0, 0}}, 0, {{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8}}},
		{{{~0u, ~0u, ~0u, ~0u}}, ~(uint64_t)0, {{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd}}},
		{{{0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}}, 0x299f31d0a4093822,
			{{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}}},
	};
	double mean = 0, variance = 0;
	bool right = true;

	for (const auto &k : known)
		right = right && !memcmp(philox4x32_10(k.counter, k.key).word, k.answer.word, sizeof k.answer.word);
	for (uint32_t i = 0; i < 100000; i++) {
		const double x = philox_bell(philox4x32_10({{i, 0, 0, 0}}, 0).word[i % 4]) / PHILOX_DEVIATION;

		mean += x / 100000;
		variance += x * x / 100000;
	}
	return wrong(right, "Philox4x32-10 does not give its known answers") |
	       wrong(std::fabs(mean) < 0.02 && std::fabs(variance - 1) < 0.02,
		       "the noise has another mean or variance");
}

/* Without torque and friction the energy stays; halving the step shows the order of what it is off. */
static int check_swing()
{
	static const struct {
		integrator method;
		const char *name;
		double dt, least, most; /* orders */
	} all[] = {{EULER, "semi-implicit Euler", 0.001, 0.8, 1.2}, {RK4, "Runge-Kutta", 0.002, 3.5, 5.5}};
	int bad = 0;

	for (const auto &one : all) {
		const double drift = swing_drift(one.method, one.dt), half = swing_drift(one.method, one.dt / 2);
		const double order = std::log2(drift / half);

		printf("free swing, %s: energy off by %.2g J in steps of %g s, %.2g J in half of them: order %.2f\n",
			one.name, drift, one.dt, half, order);
		bad |= wrong(order > one.least && order < one.most, "the order of an integrator");
	}
	return bad;
}

/* Where the arm shall be: from pose to pose, one a second, along cubics. The arm begins elsewhere. */
static arm goal_at(double seconds)
{
	static const double away[][N] = {{0.2, 0.1, -0.1, 0.2, 0.1, -0.2, 0.2}, {0.7, 0.3, -0.3, 0.5, 0.6, 0.3, -0.5},
		{0.2, 0.5, 0.4, -0.3, -0.5, 0.5, 0.3}, {-0.6, -0.2, 0.2, 0.4, 0.3, -0.3, 0.7}};
	const int poses = sizeof away / sizeof away[0], pose = (int)seconds;
	const double *const from = away[pose % poses], *const to = away[(pose + 1) % poses], x = seconds - pose;
	arm goal = {{READY}, {}};

	for (int j = 0; j < N; j++) {
		goal.q[j] += from[j] + (to[j] - from[j]) * x * x * (3 - 2 * x);
		goal.qd[j] = (to[j] - from[j]) * 6 * x * (1 - x);
	}
	return goal;
}

static std::vector<arm> goals_from(uint32_t tick, int steps)
{
	std::vector<arm> goals;

	for (int i = 1; i <= steps; i++)
		goals.push_back(goal_at(((double)tick + i) * DT));
	return goals;
}

/* What came of a run: errors are the distance of q from the goal, rad. */
struct outcome {
	double first_error, last_second, worst; /* rms over the last second; the largest after the first second */
	uint64_t sum;				/* of all costs and speeds */
};

static double distance(const arm &a, const arm &b)
{
	double sum = 0;

	for (int j = 0; j < N; j++)
		sum += (a.q[j] - b.q[j]) * (a.q[j] - b.q[j]);
	return std::sqrt(sum);
}

static void write_line(FILE *out, double seconds, const arm &a, const arm &goal, const std::vector<double> &costs)
{
	double least = (double)INFINITY;

	for (double cost : costs)
		least = std::fmin(least, cost);
	fprintf(out, "%.2f,%.9g,%.9g", seconds, distance(a, goal), least);
	for (int j = 0; j < N; j++)
		fprintf(out, ",%.9g,%.9g", a.q[j], goal.q[j]);
	fputc('\n', out);
}

static FILE *open_trace(const options &o, const char *where)
{
	FILE *out = fopen(o.trace, "w");

	if (!out) {
		fprintf(stderr, "rollout: %s: cannot be written\n", o.trace);
		return NULL;
	}
	fprintf(out, "# %zu rollouts of %d steps on %s, in %s, %s\n", o.s.rollouts, o.s.steps, where,
		o.s.is_f64 ? "f64" : "f32", o.s.method == EULER ? "semi-implicit Euler" : "Runge-Kutta");
	fprintf(out, "seconds,error,least_cost");
	for (int j = 1; j <= N; j++)
		fprintf(out, ",q%d,goal%d", j, j);
	fputc('\n', out);
	return out;
}

/* The loop: sample, move. */
static int follow(controller &c, const options &o, FILE *trace, outcome *result)
{
	const int ticks = (int)(o.seconds / DT + 0.5), second = (int)(1 / DT + 0.5);
	arm a = {{READY}, {}};
	std::vector<double> costs;
	double speed[N], squares = 0;

	*result = {distance(a, goal_at(0)), 0, 0, 0xcbf29ce484222325};
	for (int tick = 0; tick < ticks; tick++) {
		if (c.next((uint32_t)tick, a, goals_from((uint32_t)tick, o.s.steps), speed) || c.costs(costs))
			return 1;
		hash(&result->sum, costs.data(), costs.size());
		hash(&result->sum, speed, N);
		if (trace)
			write_line(trace, tick * DT, a, goal_at(tick * DT), costs);
		arm_moves(a, speed);
		const double error = distance(a, goal_at((tick + 1) * DT));

		if (!(error < 100))
			return wrong(false, "the arm is lost");
		if (tick >= second)
			result->worst = std::fmax(result->worst, error);
		if (tick >= ticks - second)
			squares += error * error;
	}
	result->last_second = std::sqrt(squares / (ticks < second ? ticks : second));
	return 0;
}

static void print_speed(const controller &c, const options &o, const outcome &r, bool on_gpu)
{
	const double per_call = c.rollout_seconds / c.calls, steps = (double)o.s.rollouts * o.s.steps;
	int registers = 0;
	size_t spilled = 0;

	if (on_gpu && gpu_registers(o.s, &registers, &spilled))
		return;
	if (o.csv) {
		printf("%s,%s,%zu,%d,%d,%zu,%.2f,%.2f,%.4g,%.5f,%016llx\n", o.s.is_f64 ? "f64" : "f32",
			o.s.method == EULER ? "euler" : "rk4", o.s.rollouts, o.s.steps, registers, spilled,
			1e6 * per_call, 1e6 * c.plan_seconds / c.calls, steps / per_call, r.last_second,
			(unsigned long long)r.sum);
		return;
	}
	printf("a tick: rollouts %.1f us, next plan %.1f us; %.3g steps a second, dynamics and noise included\n",
		1e6 * per_call, 1e6 * c.plan_seconds / c.calls, steps / per_call);
	if (on_gpu)
		printf("a thread has %d registers and %zu bytes in local memory\n", registers, spilled);
}

static int control(const options &o, bool on_gpu)
{
	const char *const where = on_gpu ? gpu_name() : "the host";
	const std::unique_ptr<controller> c(on_gpu ? gpu_controller(o.s) : host_controller(o.s));
	FILE *const trace = c && o.trace ? open_trace(o, where) : NULL;
	outcome r;
	int bad;

	if (!c || (o.trace && !trace))
		return 1;
	if (!o.csv)
		printf("%zu rollouts of %d steps on %s, in %s, %s\n", o.s.rollouts, o.s.steps, where,
			o.s.is_f64 ? "f64" : "f32", o.s.method == EULER ? "semi-implicit Euler" : "Runge-Kutta");
	bad = follow(*c, o, trace, &r);
	if (trace && fclose(trace) && !bad)
		bad = wrong(false, "the trace cannot be written");
	if (bad)
		return 1;
	if (!o.csv) {
		printf("distance from the goal: %.4f rad at first, ", r.first_error);
		if (o.seconds > 1)
			printf("%.4f after a second at most, ", r.worst);
		printf("%.4f in the last second\n", r.last_second);
		printf("hash of all costs and speeds: %016llx\n", (unsigned long long)r.sum);
	}
	print_speed(*c, o, r, on_gpu);
	return 0;
}

/* One tick on the GPU and on the host. */
static int compare(const settings &s)
{
	const arm begin = {{READY}, {}};
	const std::unique_ptr<controller> gpu(gpu_controller(s)), host(host_controller(s));
	std::vector<double> costs[2];
	double speed[2][N], most = 0, limit = s.is_f64 ? 1e-8 : 1e-2;
	size_t same = 0;

	if (!gpu || !host || gpu->next(0, begin, goals_from(0, s.steps), speed[0]) || gpu->costs(costs[0]) ||
		host->next(0, begin, goals_from(0, s.steps), speed[1]) || host->costs(costs[1]))
		return 1;
	for (size_t k = 0; k < s.rollouts; k++) {
		same += !memcmp(&costs[0][k], &costs[1][k], sizeof(double));
		most = std::fmax(most, std::fabs(costs[0][k] / costs[1][k] - 1));
	}
	printf("GPU and host, %s: %zu of %zu costs are the same to the bit, the others to %.1e; the speeds %s\n",
		IS_STRICT ? "--strict" : "not --strict", same, s.rollouts, most,
		memcmp(speed[0], speed[1], sizeof speed[0]) ? "differ" : "are the same");
	if (IS_STRICT)
		return wrong(same == s.rollouts && !memcmp(speed[0], speed[1], sizeof speed[0]),
			"the GPU and the host have other bits");
	return wrong(most < limit, "the GPU's costs, or the host's");
}

/* One option with its value, if it has one, from argv[*i] on. */
static bool read_option(options *o, char **argv, int *i)
{
	const char *v;
	char *end;

	if ((v = value_of("--rollouts", argv, i)))
		return (o->s.rollouts = whole(v, 1u << 28)) > 0;
	if ((v = value_of("--steps", argv, i)))
		return (o->s.steps = (int)whole(v, 10000)) > 0;
	if ((v = value_of("--seed", argv, i)))
		return (o->s.seed = whole(v, ~0ull)) > 0;
	if ((v = value_of("--seconds", argv, i)))
		return (o->seconds = strtod(v, &end)) >= 2 * DT && o->seconds <= 1e6 && !*end;
	if ((v = value_of("--integrator", argv, i)))
		return (o->s.method = strcmp(v, "rk4") ? EULER : RK4) == RK4 || !strcmp(v, "euler");
	if ((v = value_of("--precision", argv, i)))
		return (o->s.is_f64 = !strcmp(v, "f64")) || !strcmp(v, "f32");
	if ((v = value_of("--trace", argv, i)))
		return (o->trace = v);
	return read_flag(argv[*i], {{"--cpu", &o->cpu}, {"--check", &o->check}, {"--csv", &o->csv}, {"--help", &o->help}});
}

int main(int argc, char **argv)
{
	options o = {{16384, 64, EULER, false, 1}, 4, false, false, false, false, NULL};
	const char *lacks;

	for (int i = 1; i < argc; i++)
		if (!read_option(&o, argv, &i)) {
			fprintf(stderr, "rollout: not understood: %s\n%s", argv[i], USAGE);
			return 2;
		}
	if (o.help) {
		fputs(USAGE, stdout);
		return 0;
	}
	lacks = gpu_lacks();
	if (wrong(limits_match(), "the limits of rollout.h are not the URDF's") || check_philox())
		return 1;
	if (!o.csv && !o.check && check_swing())
		return 1;
	if (lacks && !o.cpu)
		fprintf(o.csv ? stderr : stdout, "skipped: the GPU: %s\n", lacks);
	if (o.check)
		return lacks ? 0 : compare(o.s);
	return control(o, !lacks && !o.cpu);
}
