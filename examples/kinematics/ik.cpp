/* ik: where must the joints of a Panda be for its hand to be there? A million goals at once, by damped least squares
   (Nakamura and Hanafusa 1986, Sugihara 2011), within the limits of the joints; a search that does not arrive begins again
   elsewhere. ik --help lists the options.

   Every run compares what was found with poses in double precision, and the limits with the URDF's. reach.gp draws what --map
   writes. */
#include "ik.h"
#include "../common.h"
#include "../philox.h"
#include <algorithm>
#include <cmath>

const char *const PROGRAM = "ik";

struct options {
	settings s;
	size_t targets;
	bool cpu, check, csv, help;
	const char *map;
	int cells, rotations;
};

static const char *const USAGE =
	"usage: ik [options]\n"
	"  --targets N           how many goals at once (default 1000000)\n"
	"  --precision f32|f64   of the searches (default f32)\n"
	"  --tries N             a search begins elsewhere so often at most (default 200)\n"
	"  --seed N              of goals and tries (default 1)\n"
	"  --cpu                 on the host, by all threads of OpenMP, even where there is a GPU\n"
	"  --check               the same goals on the GPU and on the host: are the results the same?\n"
	"  --map FILE.dat        instead: which share of all rotations the hand reaches, over the plane through the arm\n"
	"  --cells N             of the map, along each side (default 48)\n"
	"  --rotations N         tried in each cell of the map (default 64)\n"
	"  --csv                 print a line of figures alone\n"
	"  --help\n"
	"exit status: 0 done, 1 something is wrong or failed, 2 the command line is\n";

/* What came of a run. */
struct outcome {
	size_t reached;
	double steps, restarts;	   /* means, of the goals that were reached */
	int median, p99, most;	   /* steps of these */
	double off, turned;	   /* the largest: m, rad */
	bool is_within_limits;
	uint64_t sum;		   /* of all angles and steps */
};

/* The largest that a solution is off its goal, in f64. */
static void measure(const goal &g, const solution &x, outcome *r)
{
	const double low[N] = {LOWERS}, high[N] = {UPPERS};
	const goal is = hand_at(x.q);
	double shift = 0, sine[3], cosine = g.of[6] * is.of[6];

	for (int i = 0; i < 3; i++) {
		const int j = (i + 1) % 3, k = (i + 2) % 3;
		const double *a = g.of + 3, *b = is.of + 3;

		shift += (g.of[i] - is.of[i]) * (g.of[i] - is.of[i]);
		sine[i] = b[3] * a[i] - a[3] * b[i] - (a[j] * b[k] - a[k] * b[j]);
		cosine += a[i] * b[i];
	}
	r->off = std::fmax(r->off, std::sqrt(shift));
	const double length = std::sqrt(sine[0] * sine[0] + sine[1] * sine[1] + sine[2] * sine[2]);

	r->turned = std::fmax(r->turned, 2 * std::atan2(length, std::fabs(cosine)));
	for (int j = 0; j < N; j++) /* a limit in f32 may be above the same in f64 by its rounding */
		r->is_within_limits = r->is_within_limits && x.q[j] >= low[j] - 2e-7 && x.q[j] <= high[j] + 2e-7;
}

static outcome judge(const std::vector<goal> &goals, const std::vector<solution> &found)
{
	outcome r = {0, 0, 0, 0, 0, 0, 0, 0, true, 0xcbf29ce484222325};
	std::vector<int> steps;

	for (size_t k = 0; k < goals.size(); k++) {
		const double both[2] = {(double)found[k].steps, (double)found[k].tries};

		hash(&r.sum, found[k].q, N);
		hash(&r.sum, both, 2);
		if (found[k].tries == 0)
			continue;
		measure(goals[k], found[k], &r);
		steps.push_back(found[k].steps);
		r.steps += found[k].steps;
		r.restarts += found[k].tries - 1;
	}
	r.reached = steps.size();
	if (r.reached == 0)
		return r;
	std::sort(steps.begin(), steps.end());
	r.steps /= (double)r.reached;
	r.restarts /= (double)r.reached;
	r.median = steps[r.reached / 2];
	r.p99 = steps[r.reached - 1 - r.reached / 100];
	r.most = steps.back();
	return r;
}

static std::vector<goal> random_goals(size_t count, uint64_t seed)
{
	std::vector<goal> goals(count);

	for (size_t k = 0; k < count; k++) {
		double q[N];

		draw_angles(seed, (uint32_t)k, q);
		goals[k] = hand_at(q);
	}
	return goals;
}

static void print(const options &o, const outcome &r, double seconds, bool on_gpu)
{
	int registers = 0;
	size_t spilled = 0;

	if (on_gpu && gpu_registers(o.s, &registers, &spilled))
		return;
	if (o.csv) {
		printf("%s,%zu,%zu,%.3f,%d,%d,%d,%.4f,%d,%zu,%.6g,%.3g,%.3g,%016llx\n", o.s.is_f64 ? "f64" : "f32",
			o.targets, r.reached, r.steps, r.median, r.p99, r.most, r.restarts, registers, spilled, seconds,
			r.off, r.turned, (unsigned long long)r.sum);
		return;
	}
	printf("reached: %zu, %.4f %%, within %.3g mm and %.3g rad\n", r.reached, 100 * (double)r.reached / (double)o.targets,
		1e3 * r.off, r.turned);
	printf("steps: %.2f in the mean, %d in the median, %d for 99 of 100, %d at most; %.3f restarts in the mean\n", r.steps,
		r.median, r.p99, r.most, r.restarts);
	printf("hash of all angles and steps: %016llx\n", (unsigned long long)r.sum);
	printf("%.4g s: %.3g goals a second\n", seconds, (double)o.targets / seconds);
	if (on_gpu)
		printf("a thread has %d registers and %zu bytes in local memory\n", registers, spilled);
}

static int search_all(const options &o, bool on_gpu)
{
	const std::vector<goal> goals = random_goals(o.targets, o.s.seed);
	std::vector<solution> found;
	double seconds;

	if (!o.csv)
		printf("%zu goals on %s, in %s\n", o.targets, on_gpu ? gpu_name() : "the host", o.s.is_f64 ? "f64" : "f32");
	if ((on_gpu ? solve_on_gpu : solve_on_host)(o.s, goals, found, &seconds))
		return 1;
	const outcome r = judge(goals, found);

	print(o, r, seconds, on_gpu);
	return wrong(r.is_within_limits, "an angle is beyond its limit") |
	       wrong(r.off <= TOLERANCE && r.turned <= TOLERANCE_ANGLE, "a hand is not where it shall be");
}

/* The same goals on the GPU and on the host. */
static int compare(const options &o)
{
	const std::vector<goal> goals = random_goals(o.targets, o.s.seed);
	std::vector<solution> found[2];
	double seconds;
	size_t same = 0;

	if (solve_on_gpu(o.s, goals, found[0], &seconds) || solve_on_host(o.s, goals, found[1], &seconds))
		return 1;
	for (size_t k = 0; k < o.targets; k++)
		same += !memcmp(found[0][k].q, found[1][k].q, sizeof found[0][k].q) && found[0][k].steps == found[1][k].steps;
	const outcome gpu = judge(goals, found[0]), host = judge(goals, found[1]);

	printf("GPU and host, %s: %zu of %zu searches are the same to the bit; %zu and %zu reach their goal\n",
		IS_STRICT ? "--strict" : "not --strict", same, o.targets, gpu.reached, host.reached);
	if (IS_STRICT)
		return wrong(same == o.targets, "the GPU and the host have other bits");
	return wrong(std::fabs(gpu.steps - host.steps) < 0.05 * host.steps, "the GPU's steps, or the host's");
}

/* ---- the map ---- */

/* Uniform in the ball of four dimensions, scaled to length 1: uniform over rotations. */
static void draw_rotation(uint64_t seed, uint32_t k, double u[4])
{
	double square = 0;

	for (uint32_t again = 0; square < 0.01 || square > 1; again++) {
		const philox a = philox4x32_10({{k, again, 2, 0}}, seed);

		square = 0;
		for (int i = 0; i < 4; i++) {
			u[i] = a.word[i] / 2147483648.0 - 1;
			square += u[i] * u[i];
		}
	}
	for (int i = 0; i < 4; i++)
		u[i] /= std::sqrt(square);
}

/* Where a cell is: x from -1 to 1 m, z from -0.6 to 1.4 m, y = 0. */
static goal goal_in_cell(const options &o, int column, int row, uint32_t rotation)
{
	goal g = {{2 * (column + 0.5) / o.cells - 1, 0, 2 * (row + 0.5) / o.cells - 0.6, 0, 0, 0, 1}};

	draw_rotation(o.s.seed, rotation, g.of + 3);
	return g;
}

static int write_map(const options &o, const std::vector<solution> &found)
{
	FILE *out = fopen(o.map, "w");
	size_t k = 0;

	if (!out) {
		fprintf(stderr, "ik: %s: cannot be written\n", o.map);
		return 1;
	}
	fprintf(out, "# x, m; z, m; the share of %d rotations that the hand of a Panda reaches there\n", o.rotations);
	for (int row = 0; row < o.cells; row++) {
		for (int column = 0; column < o.cells; column++) {
			const goal g = goal_in_cell(o, column, row, 0);
			int reached = 0;

			for (int i = 0; i < o.rotations; i++)
				reached += found[k++].tries > 0;
			fprintf(out, "%.4f %.4f %.4f\n", g.of[0], g.of[2], (double)reached / o.rotations);
		}
		fputc('\n', out);
	}
	return wrong(!ferror(out) & !fclose(out), "the map cannot be written");
}

static int map(const options &o, bool on_gpu)
{
	std::vector<goal> goals;
	std::vector<solution> found;
	double seconds;

	for (int row = 0; row < o.cells; row++)
		for (int column = 0; column < o.cells; column++)
			for (int i = 0; i < o.rotations; i++)
				goals.push_back(goal_in_cell(o, column, row, (uint32_t)goals.size()));
	if ((on_gpu ? solve_on_gpu : solve_on_host)(o.s, goals, found, &seconds) || write_map(o, found))
		return 1;
	const outcome r = judge(goals, found);

	printf("map of %d x %d cells, %d rotations each, on %s, in %s: %zu of %zu are reached; %.4g s\n", o.cells,
		o.cells, o.rotations, on_gpu ? gpu_name() : "the host", o.s.is_f64 ? "f64" : "f32", r.reached,
		goals.size(), seconds);
	return wrong(r.is_within_limits && r.off <= TOLERANCE && r.turned <= TOLERANCE_ANGLE, "a hand is not where it shall be");
}

/* ---- options ---- */

/* One option with its value, if it has one, from argv[*i] on. */
static bool read_option(options *o, char **argv, int *i)
{
	const char *v;

	if ((v = value_of("--targets", argv, i)))
		return (o->targets = whole(v, 1u << 28)) > 0;
	if ((v = value_of("--tries", argv, i)))
		return (o->s.tries = (int)whole(v, 1000000)) > 0;
	if ((v = value_of("--seed", argv, i)))
		return (o->s.seed = whole(v, ~0ull)) > 0;
	if ((v = value_of("--cells", argv, i)))
		return (o->cells = (int)whole(v, 1000)) > 0;
	if ((v = value_of("--rotations", argv, i)))
		return (o->rotations = (int)whole(v, 100)) > 0;
	if ((v = value_of("--precision", argv, i)))
		return (o->s.is_f64 = !strcmp(v, "f64")) || !strcmp(v, "f32");
	if ((v = value_of("--map", argv, i)))
		return (o->map = v);
	return read_flag(argv[*i], {{"--cpu", &o->cpu}, {"--check", &o->check}, {"--csv", &o->csv}, {"--help", &o->help}});
}

int main(int argc, char **argv)
{
	options o = {{200, false, 1}, 1000000, false, false, false, false, NULL, 48, 64};
	const char *lacks;

	for (int i = 1; i < argc; i++)
		if (!read_option(&o, argv, &i)) {
			fprintf(stderr, "ik: not understood: %s\n%s", argv[i], USAGE);
			return 2;
		}
	if (o.help) {
		fputs(USAGE, stdout);
		return 0;
	}
	lacks = gpu_lacks();
	if (wrong(limits_match(), "the limits of ik.h are not the URDF's"))
		return 1;
	if (lacks && !o.cpu)
		fprintf(o.csv ? stderr : stdout, "skipped: the GPU: %s\n", lacks);
	if (o.check)
		return lacks ? 0 : compare(o);
	return o.map ? map(o, !lacks && !o.cpu) : search_all(o, !lacks && !o.cpu);
}
