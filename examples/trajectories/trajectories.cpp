/* trajectories TEXT.cu [COUNT [CURVE.csv]]: COUNT trajectories of a KUKA iiwa 14 between random poses, each bent until
   it takes the least torque: the integral of |tau / effort|^2 is minimised by Gauss and Newton's method, damped
   (Levenberg 1944, Marquardt 1963), with the exact derivatives of TEXT (rneagen --want tau,dtau_dq,dtau_dqd,M). All of
   them go at once, and on a GPU nothing leaves it before the end: a round is three launches, of which librnea makes the
   middle one (trajectories_step.h). TEXT is in f32 or f64, and so is then all else. Angles and speeds are held within
   their limits by springs, efforts only by being weights; what the arm may run into is not modelled.

   The gradient and J'J are held against differences, the costs in the end against the C function in double precision;
   on a GPU the costs after every round are held against those of the same rounds on the host. CURVE.csv has the costs
   of every round, which trajectories.gp plots. */
#include "trajectories.h"
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

static const int ROUNDS = 41;
static const size_t BENT = 8, COMPARED = 200;
static const double AGREEMENT = 1e-4;

/* Returns whether something is wrong, having said what. */
static int wrong(bool is_right, const char *what)
{
	if (!is_right)
		fprintf(stderr, "trajectories: wrong: %s\n", what);
	return !is_right;
}

static rnea_robot *open_text(const char *path, rnea_backend backend)
{
	static const char *const names[] = {"q", "qd", "qdd", "tau", "dtau_dq", "dtau_dqd", "M"};
	rnea_options options = {};
	rnea_robot *robot;
	rnea_error error;
	bool ours;

	options.backend = backend;
	if (rnea_open_file(path, &options, &robot, &error)) {
		fprintf(stderr, "trajectories: %s\n", error.message);
		return NULL;
	}
	ours = rnea_info(robot)->nq == N && rnea_info(robot)->layout == RNEA_SOA &&
	       rnea_argument_count(robot, "rnea") == 7;
	for (int i = 0; i < 7; i++)
		ours = ours && rnea_bind(robot, names[i]) == i;
	if (ours)
		return robot;
	fprintf(stderr,
		"trajectories: %s: not the text of an iiwa 14; make it by "
		"rneagen iiwa14.urdf --want tau,dtau_dq,dtau_dqd,M\n",
		path);
	rnea_close(robot);
	return NULL;
}

/* Of bent trajectories, some of them beyond limits, whether the step's numbers are right. */
static int check_pairs(const rnea_robot *robot, const tables<double> &t)
{
	const double limit = rnea_info(robot)->precision == RNEA_F64 ? 1e-5 : 1e-4, tables_off = tables_error(t);
	std::vector<trajectory<double>> all = random_trajectories(BENT);
	difference most = {0, 0, 0};
	course c;

	bend(all);
	if (solve(robot, t, all, 1, c))
		return 1;
	for (const trajectory<double> &x : all) {
		const difference off = pairs_error(t, x);

		most.cost = std::fmax(most.cost, off.cost);
		most.gradient = std::fmax(most.gradient, off.gradient);
		most.matrix = std::fmax(most.matrix, off.matrix);
	}
	printf("%zu bent trajectories, beside differences in double precision: cost off by %.1e, gradient %.1e, "
	       "J'J %.1e\n",
		BENT, most.cost, most.gradient, most.matrix);
	return wrong(tables_off < 1e-4, "the tables of the shapes") | wrong(most.cost < limit, "the cost") |
	       wrong(most.gradient < limit, "the gradient") | wrong(most.matrix < limit, "J'J");
}

struct statistics {
	double mean, median, worst, kept; /* kept: the part of the trajectories that this round made better */
};

static statistics look(const course &c, size_t round)
{
	std::vector<double> costs = c.rounds[round].costs;
	const size_t count = costs.size();
	statistics s = {0, 0, 0, 0};

	for (size_t k = 0; k < count; k++) {
		s.mean += costs[k] / (double)count;
		s.kept += (round == 0 || costs[k] < c.rounds[round - 1].costs[k]) / (double)count;
	}
	std::sort(costs.begin(), costs.end());
	s.median = costs[count / 2];
	s.worst = costs[count - 1];
	return s;
}

/* A file's first lines: what ran where, how long it took, and what the columns are. */
static void write_head(FILE *out, const course &c, const rnea_robot *robot)
{
	fprintf(out, "# %zu trajectories on %s, in %s", c.rounds[0].costs.size(), rnea_build(robot)->device,
		rnea_info(robot)->arithmetic);
	if (c.milliseconds > 0)
		fprintf(out, ": %zu rounds in %.2f ms", c.rounds.size(), (double)c.milliseconds);
	fprintf(out, "\nround,mean,median,worst,kept,sample_us,rnea_us,step_us\n");
}

/* The table on the screen and, if wanted, in a file. */
static int write_course(const course &c, const rnea_robot *robot, const char *path)
{
	FILE *out = path ? fopen(path, "w") : NULL;

	if (out)
		write_head(out, c, robot);
	printf("%5s %12s %12s %12s %6s %30s\n", "round", "mean cost, s", "median", "worst", "kept",
		c.milliseconds > 0 ? "samples, rnea, step, us" : "");
	for (size_t r = 0; r < c.rounds.size(); r++) {
		const float *ms = c.rounds[r].milliseconds;
		const statistics s = look(c, r);

		printf("%5zu %12.6f %12.6f %12.6f %6.3f", r, s.mean, s.median, s.worst, s.kept);
		if (c.milliseconds > 0)
			printf(" %9.1f %9.1f %9.1f", 1e3 * (double)ms[0], 1e3 * (double)ms[1], 1e3 * (double)ms[2]);
		printf("\n");
		if (!out)
			continue;
		fprintf(out, "%zu,%.9g,%.9g,%.9g,%.4f", r, s.mean, s.median, s.worst, s.kept);
		if (c.milliseconds > 0)
			fprintf(out, ",%.2f,%.2f,%.2f\n", 1e3 * (double)ms[0], 1e3 * (double)ms[1],
				1e3 * (double)ms[2]);
		else
			fprintf(out, ",,,\n");
	}
	if (!path || (out && !fclose(out)))
		return 0;
	fprintf(stderr, "trajectories: %s: cannot be written\n", path);
	return 1;
}

static void print_times(const course &c, size_t count)
{
	double parts[3] = {0, 0, 0}, all = 0;

	for (const course::round &r : c.rounds)
		for (int i = 0; i < 3; i++) {
			parts[i] += (double)r.milliseconds[i];
			all += (double)r.milliseconds[i];
		}
	printf("%zu rounds of %zu samples in %.2f ms: %.0f %% sampling, %.0f %% torques and derivatives, "
	       "%.0f %% steps; %.2f us a trajectory\n",
		c.rounds.size(), count * NODES, (double)c.milliseconds, 100 * parts[0] / all, 100 * parts[1] / all,
		100 * parts[2] / all, 1e3 * (double)c.milliseconds / (double)count);
}

/* Whether every trajectory got better, and costs what is said; and what became of its limits. */
static int check_costs(const rnea_robot *robot, const tables<double> &t, const std::vector<trajectory<double>> &all)
{
	const double limit = rnea_info(robot)->precision == RNEA_F64 ? 1e-9 : 1e-4;
	double off = 0, before = 0, after = 0, most[2][3] = {};
	size_t better = 0;

	for (const trajectory<double> &x : all) {
		const double straight[C] = {}, first = exact_cost(t, x, straight, NULL),
			     last = exact_cost(t, x, x.c, NULL);

		off = std::fmax(off, std::fabs(x.cost / last - 1));
		better += last < first;
		before += first / (double)all.size();
		after += exact_cost(t, x, x.c, most[1]) / (double)all.size();
		exact_cost(t, x, straight, most[0]);
	}
	printf("%zu of %zu cost less than the straight ones, by the C function: %.4g s instead of %.4g s in the mean; "
	       "costs off by %.1e at most\n",
		better, all.size(), after, before, off);
	printf("at most %.4f rad and %.4f rad/s beyond limits, and %.2f of an effort (straight: %.2f)\n", most[1][0],
		most[1][1], most[1][2], most[0][2]);
	return wrong(better == all.size(), "a trajectory did not get better") | wrong(off < limit, "a cost");
}

/* The same rounds over the first trajectories on the host. Now and then rounding decides, where a round gains next to
   nothing, whether it is kept, and the two part: f32 and f64 do so on 6 of 100. All others must agree. */
static int check_host(const char *path, const tables<double> &t, const course &gpu)
{
	std::vector<trajectory<double>> all = random_trajectories(std::min(gpu.rounds[0].costs.size(), COMPARED));
	rnea_robot *robot = open_text(path, RNEA_BACKEND_HOST);
	const double least = robot && rnea_info(robot)->precision == RNEA_F64 ? 0.97 : 0.8;
	size_t agree = 0;
	double most = 0;
	course c;
	const int bad = !robot || solve(robot, t, all, ROUNDS, c);

	for (size_t k = 0; k < all.size() && !bad; k++) {
		double off = 0;

		for (size_t r = 0; r < c.rounds.size(); r++)
			off = std::fmax(off, std::fabs(gpu.rounds[r].costs[k] / c.rounds[r].costs[k] - 1));
		agree += off < AGREEMENT;
		most = off < AGREEMENT ? std::fmax(most, off) : most;
	}
	if (!bad)
		printf("on the host: %zu of %zu have the same costs after every round, to %.1e\n", agree, all.size(),
			most);
	rnea_close(robot);
	return bad || wrong((double)agree >= least * (double)all.size(), "the GPU's costs, or the host's");
}

static int run(const rnea_robot *robot, const char *path, size_t count, const char *curve)
{
	const bool gpu = rnea_build(robot)->backend == RNEA_BACKEND_CUDA;
	const tables<double> t = make_tables();
	std::vector<trajectory<double>> all = random_trajectories(count);
	course c;

	printf("on %s, in %s\n", rnea_build(robot)->device, rnea_info(robot)->arithmetic);
	if (SOLVES_ON_GPU && !gpu)
		printf("skipped: the GPU: %s\n", rnea_build(robot)->note);
	if (check_pairs(robot, t) || solve(robot, t, all, ROUNDS, c) || write_course(c, robot, curve))
		return 1;
	if (gpu)
		print_times(c, count);
	return check_costs(robot, t, all) || (gpu && check_host(path, t, c));
}

int main(int argc, char **argv)
{
	const size_t count = argc > 2 ? strtoul(argv[2], NULL, 10) : 100;
	rnea_robot *robot;
	int bad;

	if (argc < 2 || argc > 4 || count == 0) {
		fprintf(stderr, "usage: trajectories TEXT.cu [COUNT [CURVE.csv]]\n");
		return 2;
	}
	robot = open_text(argv[1], SOLVES_ON_GPU ? RNEA_BACKEND_ANY : RNEA_BACKEND_HOST);
	bad = !robot || run(robot, argv[1], count, argc > 3 ? argv[3] : NULL);
	rnea_close(robot);
	return bad;
}
