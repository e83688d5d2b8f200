#include "plan/limbs/limb_limits.h"
#include "plan/stage.h"

/* H100, one sample and 4096, us, old kernel and limbs. Four warps: hyq 2.07 and 1.24, 2.33 and 1.56; g1_29dof 5.39 and
   2.67, 6.55 and 5.49; atlas in f64 6.60 and 3.20, 8.03 and 7.40. Eight warps are better where four are long:
   g1_brainco 20.6 and 8.8, with four 11.2; atlas gains nothing from them, its gradients in 4 parts take 10.9 instead
   of 9.7, and two warps are slower. With sines made first, one sample by four warps and eight: qdd of atlas 3.8 and 5.4, in
   f64 10.3 and 9.0, tau of g1_brainco 4.4 and 6.4, in f64 11.4 and 8.9, with the vjp of jvrc1 9.4 and 8.5, in f64 15.2 and 9.6.
   Arms gain nothing: iiwa14 1.42 and 1.50. Functions of more operations were not measured: it takes seconds to share them out,
   and more values than there are registers wait in each warp. Of one function alone, H200, one sample and 256: tau and vjp of
   floating jvrc1, 10048 operations, 23 and 10, 23 and 13, in f64 36 and 15, 38 and 20; of the two kernels of a vjp of atlas,
   welded by both feet, of which the first has more than 14000, 70 and 31, 74 and 34, in f64 129 and 56, 138 and 59. */
enum { LEAST_OPERATIONS = 800, MOST_OPERATIONS = 10000, MOST_ALONE = 19000, WARPS = 4, FEWER_WARPS = 3, FEWER_PERCENT = 90,
	MORE_WARPS = 8 };

/* More warps are more code, since several make the same values; and what one multiprocessor has no room for is fetched each time,
   an instruction in 1.3 cycles for all its warps together. So the number of warps is that of the least cost, in operations: those
   of the longest warp, a share of those that all warps have beyond `room`, and some for each value that a warp has at once beyond
   `values`, which then waits in memory; `least` is what an empty kernel takes, and waiting. Fitted to 210 times of 78 texts with
   3, 4 and 8 warps, in f32 and f64, of one sample (weight 0.7), 256 and 1024 (H100). Eight where four have more than 2000
   operations, and four else, was the rule before: of 28 texts that changed, one sample takes 0.85 of the time, 256 0.87, 1024
   0.82; of 8 others, to which nothing was fitted, 0.96, 0.90 and 0.85. One sample by three warps, four and eight, us: qdd of
   floating baxter 4.3 7.3 8.2; tau with the vjp of floating pr2 5.6 7.4 7.6; in f64 qdd of floating hyq 4.2 6.0 7.2, of floating
   anymal_kinova 6.0 10.2 10.5, of atlas 7.0 10.3 9.0; but tau with the vjp of romeo 9.1 9.6 7.4, of shadow_hand_right 5.8 5.6
   3.5. At worst it errs by a fifth: qdd of g1_29dof in f64 takes 11.0 with four instead of 9.3 with eight. Where all code has
   room four are best: eight take 0.9 to 1.05 of the time for one sample, and 1.15 for 1024. */
static const struct code_limits {
	unsigned least, room, percent, values, for_spilled;
} CODE[] = {{4560, 5000, 172, 214, 26}, {1670, 3870, 65, 171, 49}};

/* A sample of N operations takes 0.5 + 0.0015 N us, with warps of N operations 0.9 + 0.0015 N: their kernel starts so
   many operations later, and is to take nine tenths of the time. */
enum { START = 330, LATER = 270 };

/* Up to how many samples. Limbs that share nothing win at all sizes: hyq, 16384 samples, 2.45 and 2.17, its gradients
   at 4096 5.23 and 4.26. Elsewhere all multiprocessors fetch more code than before: 1024 samples and 4096, atlas 5.14
   and 3.94, 5.80 and 5.61; gradients of iiwa14 4.08 and 3.63, 4.28 and 5.10, of atlas, in parts, 18.3 and 12.6, 21.6
   and 34.3. */
enum { SHORT_OPERATIONS = 1500, MOST_SHORT = 16384, MOST_LONG = 4096, MOST_JOINED = 1024 };

/* With sines made first in f64, 2048 samples, whole and limbs: tau of chain_75 43.1 and 27.7, of g1_brainco 21.1 and 18.3, but of
   jvrc1 7.2 and 7.7; gradients in parts gain nothing there, nor do f32 texts. */
enum { MOST_FIRST_F64 = 2048 };

/* Beside segments, unless limbs gain little: a block for each multiprocessor. H200, 2048, 4096 and 8192 samples, segments and
   limbs, floating robots in f64: qdd of g1_29dof 32.4 28.7, 32.7 31.2, 38.0 62.7, of simple_humanoid 22.8 13.7, 22.6 14.5, 25.1
   14.5; tau of jvrc1 11.8 8.6, 11.6 9.3, 12.2 9.5, of g1_brainco 33.3 20.7, 32.8 22.4, 36.0 45.1, in f32 17.6 15.1, 16.7 16.0,
   16.9 16.1; tau and vjp of atlas 33.4 19.6, 49.6 21.7, 81.1 42.0. Of 15 texts, 2 gain little: one sample of qdd of baxter takes
   12.8 and 14.2, of yumi 17.9 and 16.7 (results/limbs_segments_h200.csv). */
enum { MOST_BESIDE_SEGMENTS = 4096 };

/* Limbs that share much, or something and gain little, win within one block alone; one sample and 1024, us, whole and limbs, with
   values across for 100 operations: both gradients of iiwa14 3.68 and 2.40, 4.08 and 3.63 (3.2); of ur5 2.52 and 2.14,
   2.59 and 3.18 (7.0); of panda in f64 7.17 and 6.37, 7.54 and 9.32 (5.9); accelerations of floating hyq 4.76 and
   3.50, 5.43 and 6.17 (9.6). Of panda, which share 1.8, but gain little: 1.84 for one sample, 2.99 for 1024, whole
   2.21. */
enum { MOST_SHARING = 32, SHARED_PERCENT = 4, GAIN_PERCENT = 65 };

/* How long limbs take beside the other kernel, for batches of 32, 256, 512 ... 16384: exp((at + the rest) / 1000), where the rest
   is a sum, each by its factor, over the operations of the whole: operations of the longest warp, and of all warps; ten times the
   values across, the values of the whole beyond `room`, and the rows that are stored. tests/gpu/fit_limbs fits these to 115 texts
   of 15 robots, fixed and floating, of torques, accelerations, vjp and gradients (H200). By a fit of the other robots what is
   launched takes 1.01 to 1.03 of the time of the better kernel, in the mean of all batches; by the rule for what is not fitted
   1.07 to 1.15. In aos elements of a row stand a sample apart, so rows that are stored count. */
static const unsigned FITTED_BATCHES[] = {32, 256, 512, 1024, 2048, 4096, 8192, 16384};
enum { BATCHES = sizeof FITTED_BATCHES / sizeof *FITTED_BATCHES, LEAST_SAMPLES = 8, WHOLE_START = 1300, LIMBS_START = 600,
	WORTH = -30 };
static const struct fitted {
	int room, at[BATCHES], longest, sum, slots, over, stores;
} FITTED[2][2] = {
	{{150, {-1869, -1733, -1666, -1526, -1446, -1386, -1344, -1096}, 2074, 680, -95, 528, 0},
		{150, {-1505, -1373, -1324, -1248, -1185, -1096, -847, -471}, 372, 1041, -325, 28, 2750}},
	{{90, {-1053, -922, -850, -689, -616, -539, -516, -139}, 1642, -220, 328, -776, 0},
		{90, {-1243, -1084, -1039, -954, -900, -810, -600, -209}, 489, 572, 596, -1610, 2361}},
};

/* A block of two groups fetches code for both: atlas, 1024 samples, 4.97 and 3.94; but hyq 1.38 and 1.52. */
enum { GROUPS = 2, REGISTERS = 65536, SPARE_REGISTERS = 24, MOST_THREADS = 1024 };

/* Beside parts that share nothing, of accelerations and of vjp, which take no longer for fewer samples. H100, us, qdd of
   atlas in f32 at 1024 samples 8.4 and in parts 5.9; f64, limbs for 1, 256 and 1024 samples, and parts for 4096: qdd of
   atlas 10.7 13.4 18.7 and 17.3, of g1_29dof 14.7 17.8 24.1 and 11.5, of jvrc1 17.6 21.9 30.4 and 23.5; tau and vjp of
   atlas 9.5 12.2 17.2 and 20.1, of g1_29dof 11.0 14.5 20.7 and 13.6, of romeo 17.2 for 1024 and 14.5, of baxter 6.9 and
   5.9. With sines made first, one sample, 256 and 512, in parts and by limbs: qdd of atlas 6.4 6.2 6.2 and 4.2 5.1 5.6, in
   f64 10.4 9.4 9.8 and 9.5 10.2 11.4, of g1_29dof in f64 8.7 9.4 9.8 and 9.8 10.6 11.8; tau and vjp of atlas 6.4 6.2 6.4
   and 4.4 5.3 5.8, in f64 17.8 15.0 13.9 and 9.0 9.6 10.3, of jvrc1 20.2 20.6 20.3 and 10.1 11.4 12.8, of g1_29dof 11.3 11.1 11.4
   and 9.4 12.2 13.5, of romeo 10.4 9.9 10.7 and 9.7 11.5 12.4. Warps for each part instead of for the whole, one sample, 256 and
   1024: qdd of g1_29dof 5.8 7.7 10.5 and 3.9 4.7 7.3, in f64 9.3 11.8 15.8 and 10.0 10.7 14.9, of atlas in f64 9.1 11.4 15.2
   and 10.4 12.1 16.4; tau and vjp of jvrc1 8.5 11.9 16.8 and 7.4 8.3 11.6, of g1_29dof in f64 9.4 12.2 16.6 and 10.8 11.6
   15.2. */
enum { MOST_BESIDE_PARTS = 256, MOST_BESIDE_QDD_F64 = 32 };

/* Beside a whole whose motion is made again, in f64, even where limbs share much. H200, tau and vjp, 32, 2048, 4096 and 16384
   samples, limbs over the other kernel: floating hyq 0.48 0.81 0.89 1.55, in aos 0.67 0.85 1.02 2.33; yumi in aos 0.71 0.76
   0.89 2.37; floating g1_29dof 0.43 0.77 0.85 1.92; simple_humanoid 0.63 1.07 1.17 4.25 (results/limbs_h200.csv). */
enum { MOST_BESIDE_AGAIN = 2048 };

/* At least so many samples, beside the two kernels of base_first.h. H200, us by limbs and by two kernels, of 4096 samples and of
   8192: floating atlas 22 and 42, 25 and 47, g1_29dof 31 and 45, 42 and 51, in aos 32 and 45, 64 and 51. */
enum { MOST_BESIDE_BASE = 4096 };

/* Beside the sides of a base (grid/hands/base_sides.c). H200, tau and vjp, us by limbs and in sides: f64, 1024 and 4096
   samples, floating atlas 13 28, 22 32; f32, 256 samples, floating jvrc1 13 18. */
enum { MOST_BESIDE_SIDES_F64 = 4096, MOST_BESIDE_SIDES = 1024 };

/* Outputs that go through windows have no limbs, whose warps would write elements that stand a sample apart (64 to 4096 samples,
   both gradients of hyq, whole matrices: 21 us, through windows 8.6). */

/* Kernels of long functions have the sines of all angles made before their warps part, by all threads, in one loop: a warp with
   20 sines in its lines fetches the code of each. H100, us, one sample, 32 and 1024, without and with: gradients of atlas in
   f64 15.9 15.9 24.1 and 11.1 11.8 19.1, in f32 8.4 8.4 11.3 and 8.0 8.5 11.0; tau of chain_75 14.1 14.2 25.0 and 11.1 12.6 20.1,
   in f64 25.7 25.8 42.4 and 14.4 16.4 25.1; qdd of atlas 6.2 6.3 11.0 and 3.8 4.5 7.8. What is made first waits: not so tau of
   atlas, 2.4 2.5 3.9 and 2.5 3.3 4.4, and tau with vjp of floating hyq in f64, 3.1 3.1 5.9 and 4.1 4.4 7.6. In f64, where a sine
   is three times as many instructions, it counts twice: tau of floating g1_29dof 5.7 5.8 8.9 and 3.4 4.5 6.5. */
enum { FIRST_SINES = 4100, SINE_OPERATIONS = 24 };

/* A wait costs as much as so many operations. */
enum { JOIN_OPERATIONS = 60 };

static unsigned number_bytes(const struct rneagen_options *o)
{
	return o->precision == RNEAGEN_F32 ? 4 : 8;
}

static void take_none(struct function *const *functions, int count)
{
	for (int i = 0; i < count; i++)
		functions[i]->limbs = (struct limbs){0};
}

/* Not with --strict, and not other sines than accurate ones, which are short. */
static int makes_sines_first(struct function *const *functions, int count, const struct rneagen_options *o, struct arena *a)
{
	if (o->strict || o->trig != RNEAGEN_ACCURATE)
		return 0;
	for (int i = 0; i < count; i++) {
		const struct plan *p = &functions[i]->plan;
		unsigned again = number_bytes(o) == 8 ? SINE_OPERATIONS * plan_sincos(p) : 0;

		if (limbs_operations(p, a) + again >= FIRST_SINES)
			return 1;
	}
	return 0;
}

/* Returns the operations of the longest warp; 0 where one of them gains nothing. */
static unsigned make_all(
	struct function *const *functions, int count, int warps, const struct rneagen_options *o, struct arena *a)
{
	struct limbs_limits limits = {.warps = warps,
		.across = SHARED_BYTES / WARP_THREADS / number_bytes(o) - 1, .join = JOIN_OPERATIONS,
		.has_first_sines = makes_sines_first(functions, count, o, a)};
	unsigned longest = 0;

	for (int i = 0; i < count; i++) {
		struct limbs *s = &functions[i]->limbs;

		if (!limbs_make(s, &functions[i]->plan, &limits, a) || !s->warps) {
			take_none(functions, count);
			return 0;
		}
		longest = s->longest > longest ? s->longest : longest;
	}
	return longest;
}

/* Operations of the longest function. */
static unsigned longest_function(struct function *const *functions, int count)
{
	unsigned longest = 0;

	for (int i = 0; i < count; i++)
		longest = functions[i]->limbs.whole > longest ? functions[i]->limbs.whole : longest;
	return longest;
}

/* Words of what goes across, and of sines, of a sample: an odd number, so that lanes are in banks of their own. */
static int words_across(struct function *const *functions, int count)
{
	int most = 0;

	for (int i = 0; i < count; i++) {
		int words = functions[i]->limbs.slots + 2 * functions[i]->limbs.first.count;

		most = words > most ? words : most;
	}
	return most ? most | 1 : 0;
}

static int have_room(const struct limbs *s, int groups, int words, unsigned bytes)
{
	unsigned threads = (unsigned)(groups * s->warps) * WARP_THREADS;

	return threads <= MOST_THREADS && threads * ((unsigned)s->alive * bytes / 4 + SPARE_REGISTERS) <= REGISTERS &&
	       (unsigned)(groups * words) * WARP_THREADS * bytes <= SHARED_BYTES;
}

/* Samples of a block at most, in warps: as many as have room in registers and in shared memory. */
static int most_groups(struct function *const *functions, int count, int words, unsigned bytes)
{
	int groups = longest_function(functions, count) < SHORT_OPERATIONS ? 1 : GROUPS;

	for (int i = 0; i < count; i++)
		if (!have_room(&functions[i]->limbs, groups, words, bytes))
			groups = 1;
	return groups;
}

static int gains_little(const struct limbs *s)
{
	return 100 * (s->longest + START + LATER) > GAIN_PERCENT * (s->whole + START);
}

static int shares_much(const struct limbs *s)
{
	return s->slots > 0 && ((unsigned)s->slots * 100 > s->whole * SHARED_PERCENT || gains_little(s));
}

/* Beside parts nothing is fitted. */
static unsigned most_unfitted(const struct limbs *s, int count, unsigned bytes)
{
	if (count == 1 && shares_much(s))
		return MOST_SHARING;
	if (count > 1 || s->words)
		return count == 1 && bytes == 8 && s->first.count ? MOST_FIRST_F64 : MOST_JOINED;
	return s->whole < SHORT_OPERATIONS ? MOST_SHORT : MOST_LONG;
}

/* The logarithm of the share of the other kernel's time that limbs take, but for what goes by the batch, in thousandths. */
static long long fitted_share(const struct function *p, int values, const struct fitted *x)
{
	const struct limbs *s = &p->limbs;
	long long whole = (long long)s->whole + WHOLE_START, over = values > x->room ? values - x->room : 0;

	return (x->longest * ((long long)s->longest + LIMBS_START) + x->sum * (long long)s->sum +
		       10 * (x->slots * (long long)s->slots + x->over * over + x->stores * (long long)p->dag.output_count)) / whole;
}

static unsigned most_fitted(const struct function *p, const struct rneagen_options *o, struct arena *a)
{
	const struct fitted *x = &FITTED[number_bytes(o) == 8][o->layout == RNEAGEN_AOS];
	long long share = fitted_share(p, plan_alive(&p->plan, a), x);
	unsigned most = LEAST_SAMPLES;

	for (int i = 0; i < BATCHES && x->at[i] + share <= WORTH; i++)
		most = FITTED_BATCHES[i];
	return most;
}

static unsigned most_samples(struct function *const *functions, int count, const struct rneagen_options *o, struct arena *a)
{
	const struct function *p = functions[0];
	int is_fitted = count == 1 && (p->limbs.words || o->layout == RNEAGEN_AOS);

	if (count == 1 && p->segments.count)
		return gains_little(&p->limbs) ? MOST_SHARING : MOST_BESIDE_SEGMENTS;
	return is_fitted ? most_fitted(p, o, a) : most_unfitted(&p->limbs, count, number_bytes(o));
}

/* What all of them have in common. */
static void set_launch(struct function *const *functions, int count, const struct rneagen_options *o, struct arena *a)
{
	int words = words_across(functions, count), groups = most_groups(functions, count, words, number_bytes(o));
	unsigned most;

	for (int i = 0; i < count; i++) {
		functions[i]->limbs.words = words;
		functions[i]->limbs.groups = groups;
	}
	most = most_samples(functions, count, o, a);
	for (int i = 0; i < count; i++)
		functions[i]->limbs.most = most;
}

static int can_have(struct function *const *functions, int count, const struct rneagen_options *o)
{
	unsigned most = count == 1 ? MOST_ALONE : MOST_OPERATIONS;
	int is_free = o->limbs == RNEAGEN_LIMBS_AUTO;

	if (o->limbs == RNEAGEN_LIMBS_NONE || o->precision == RNEAGEN_F32X2 || functions[0]->windows.slots)
		return 0;
	for (int i = 0; i < count; i++) {
		unsigned operations = plan_flops(plan_operations(&functions[i]->plan));

		if (dag_has_wide(&functions[i]->dag) || (is_free && (operations < LEAST_OPERATIONS || operations > most)))
			return 0;
	}
	return 1;
}

/* What code beyond the cache's room and values beyond the registers' take, in operations. */
static unsigned limbs_excess(const struct limbs *s, const struct code_limits *x)
{
	unsigned alive = (unsigned)s->alive, spilled = alive > x->values ? alive - x->values : 0;

	return spilled * x->for_spilled + (s->sum > x->room ? (s->sum - x->room) * x->percent / 100 : 0);
}

static unsigned limbs_cost(const struct limbs *s, const struct code_limits *x)
{
	return x->least + s->longest + limbs_excess(s, x);
}

static const struct code_limits *code_limits(const struct rneagen_options *o)
{
	return &CODE[number_bytes(o) == 8];
}

/* Another number of warps, where that takes less than so much of the time. */
static void try_warps(struct function *p, int warps, unsigned percent, const struct rneagen_options *o, struct arena *a)
{
	const struct code_limits *x = code_limits(o);
	struct limbs kept = p->limbs;

	if (!make_all(&p, 1, warps, o, a) || 100 * limbs_cost(&p->limbs, x) > percent * limbs_cost(&kept, x))
		p->limbs = kept;
}

/* As many warps as are best, or none. */
static void choose_warps(struct function *const *functions, int count, const struct rneagen_options *o, struct arena *a)
{
	unsigned longest = make_all(functions, count, WARPS, o, a), whole = longest_function(functions, count);

	if (longest && count == 1 && limbs_excess(&functions[0]->limbs, code_limits(o))) {
		try_warps(functions[0], MORE_WARPS, 100, o, a);
		try_warps(functions[0], FEWER_WARPS, FEWER_PERCENT, o, a);
		longest = functions[0]->limbs.longest;
	}
	if (10 * (longest + START + LATER) > 9 * (whole + START))
		take_none(functions, count);
}

int limbs_choose(struct function *const *functions, int count, const struct rneagen_options *o, struct arena *a)
{
	take_none(functions, count);
	if (!can_have(functions, count, o))
		return 1;
	if (o->limbs == RNEAGEN_LIMBS_AUTO)
		choose_warps(functions, count, o, a);
	else
		make_all(functions, count, o->limbs, o, a);
	if (functions[0]->limbs.warps)
		set_launch(functions, count, o, a);
	return !a->failed;
}

void limbs_beside_parts(struct limbs *s, int parts, const struct request *k, const struct rneagen_options *o)
{
	unsigned most = number_bytes(o) == 8 && s->first.count && k->is_forward ? MOST_BESIDE_QDD_F64 : MOST_BESIDE_PARTS;

	s->most = parts == 1 && number_bytes(o) == 8 ? MOST_BESIDE_AGAIN : most_unfitted(s, 1, number_bytes(o));
	if (parts > 1 && (k->is_forward || request_wants_derivative(k)) && s->most > most)
		s->most = most;
}

void limbs_beside_base(struct limbs *s)
{
	if (s->most < MOST_BESIDE_BASE)
		s->most = MOST_BESIDE_BASE;
}

void limbs_beside_sides(struct limbs *s, const struct rneagen_options *o)
{
	s->most = number_bytes(o) == 8 ? MOST_BESIDE_SIDES_F64 : MOST_BESIDE_SIDES;
}
