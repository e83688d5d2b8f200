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
enum { LEAST_OPERATIONS = 800, MOST_OPERATIONS = 10000, MOST_ALONE = 19000, WARPS = 4, MORE_WARPS = 8,
	MORE_PERCENT = 95 };

/* More warps are more code, since several make the same values; and what one multiprocessor has no room for is fetched each
   time, an instruction in 1.3 cycles for all its warps together. So the number of warps, four or eight, is that of the least
   cost, in operations: those of the longest warp, a share of those that all warps have beyond `room`, and some for each value
   that a warp has at once and that waits in memory; `least` is what an empty kernel takes, and waiting.
   Fitted to 733 times of 25 texts with 3, 4 and 8 warps, dealt out in some ways, in f32 and f64, of one sample (weight 0.6),
   256 and 1024 (H200); off by an eighth in the mean. Of the other robots' fit what is chosen takes 1.05 of the time of the
   best deal that was tried of a text, at worst 1.2. What a wait costs could not be seen: deals of six phases are as fast as
   such of two with as many operations. */
static const struct code_limits {
	unsigned least, room, percent;
	struct limbs_spill spill;
} CODE[] = {{2915, 2000, 130, {214, 40}}, {1714, 2500, 79, {170, 35}}};

/* A sample of N operations takes 0.5 + 0.0015 N us, with warps of N operations 0.9 + 0.0015 N: their kernel starts so
   many operations later, and is to take nine tenths of the time. */
enum { START = 330, LATER = 270 };

/* Up to how many samples. Limbs that share nothing win at all sizes: hyq, 16384 samples, 2.45 and 2.17, its gradients
   at 4096 5.23 and 4.26. Elsewhere all multiprocessors fetch more code than before: 1024 samples and 4096, atlas 5.14
   and 3.94, 5.80 and 5.61; gradients of iiwa14 4.08 and 3.63, 4.28 and 5.10, of atlas, in parts, 18.3 and 12.6, 21.6
   and 34.3. */
enum { SHORT_OPERATIONS = 1500, MOST_SHORT = 16384, MOST_LONG = 4096, MOST_JOINED = 1024 };

/* So many samples are one or two blocks of 32 or 64 for each multiprocessor: up to there limbs win beside segments, sides,
   the two kernels of base_first.h, hands in f64, a whole whose motion is made again, and a whole of more operations than were
   fitted. H200, us by limbs and by the others, of 256, 1024, 4096, 8192 and 16384 samples, floating robots: qdd of atlas in
   f32 6.3 10, 8.4 11, 10 12, 10 13, 18 13, in f64 11 32, 14 33, 15 34, 15 39, 32 48, of jvrc1 17 33, 20 35, 23 35, 23 40, 47
   63; tau and vjp of jvrc1 in f32 12 19, 15 20, 17 23, 17 24, 36 25, in f64 13 36, 17 39, 20 46, 41 70, 86 88; tau of
   g1_brainco in f64 17 31, 18 33, 20 33, 20 36, 45 69. For 8192 samples limbs lose by tau and vjp of g1_29dof in f64, 33
   28, and by tau of chain_75 in f64, 67 46 (results/limbs_beside_h200.csv). */
enum { MOST_BESIDE = 8192, MOST_FITTED = 10000 };

/* In aos there are the limits of before the deals of limbs.c left out what other warps make. H200, us by limbs and by two
   kernels, 4096 samples and 8192: qdd of floating g1_29dof 32 45, 64 51; tau and vjp in f64, limbs over the other kernel, 32,
   2048, 4096 and 16384 samples: floating hyq 0.67 0.85 1.02 2.33, yumi 0.71 0.76 0.89 2.37. */
enum { MOST_BESIDE_SEGMENTS_AOS = 4096, MOST_BESIDE_BASE_AOS = 4096, MOST_BESIDE_AGAIN_AOS = 2048, MOST_BESIDE_HANDS_AOS = 1024,
	MOST_BESIDE_HANDS_AOS_F64 = 2048, MOST_BESIDE_SIDES_AOS = 1024, MOST_BESIDE_SIDES_AOS_F64 = 4096 };

/* Parts that share nothing run side by side, and take no longer for few samples. H200, us by limbs and by two parts, of 32,
   256 and 1024 samples: qdd of atlas in f32 4.5 5.6, 5.5 6.1, 7.5 6.4, in f64 7.8 9.5, 8.3 9.1, 10.5 9.9, of baxter 2.4 2.4,
   3.1 3.3, 3.6 2.6, in f64 3.1 3.7, 4.2 4.2, 4.7 3.9; tau and vjp of atlas 4.5 5.5, 5.9 6.1, 6.4 6.7, in f64 9.6 13, 10 13,
   12 18; tau of atlas in f64 2.9 4.5, 4.1 4.8, 4.5 5.3. Hands in f32: g1_brainco 9.8 10, 10.3 9.4, 12.4 9.7. chain_75, of
   more than LONG_HANDS operations, for 1024 samples 15 27, for 4096 18 by limbs. Beside the parts of a relay's start nothing
   was measured since. */
enum { MOST_BESIDE_PARTS = 256, MOST_BESIDE_STARTS_F64 = 32, LONG_HANDS = 8000, MOST_BESIDE_LONG_HANDS = 4096 };

/* Limbs that gain little win within one block alone. */
enum { MOST_LITTLE = 32, GAIN_PERCENT = 65 };

/* How long limbs take beside the other kernel, for batches of 32, 256, 512 ... 16384: exp((at + the rest) / 1000), where the
   rest is a sum, each by its factor, over the operations of the whole: operations of the longest warp, and of all warps; ten
   times the values across, the values of the whole beyond `room`, and the rows that are stored. tests/gpu/fit_limbs fits
   these to 115 texts of 15 robots, fixed and floating, of torques, accelerations, vjp and gradients (H200). By a fit of the
   other robots what is launched takes 1.01 to 1.03 of the time of the better kernel, in the mean of all batches; by the rule
   for what is not fitted 1.07 to 1.15. In aos elements of a row stand a sample apart, so rows that are stored count. */
static const unsigned FITTED_BATCHES[] = {32, 256, 512, 1024, 2048, 4096, 8192, 16384};
enum { BATCHES = sizeof FITTED_BATCHES / sizeof *FITTED_BATCHES, LEAST_SAMPLES = 8, WHOLE_START = 1300, LIMBS_START = 600,
	WORTH = -30 };
static const struct fitted {
	int room, at[BATCHES], longest, sum, slots, over, stores;
} FITTED[2][2] = {
	{{150, {-1531, -1385, -1337, -1219, -1128, -1069, -1035, -777}, 1283, 450, 428, -78, 0},
		{150, {-1644, -1469, -1423, -1367, -1294, -1202, -975, -614}, 647, 892, -53, 118, 3206}},
	{{90, {-2100, -1974, -1886, -1705, -1647, -1568, -1558, -1167}, 3561, -22, -106, -502, 0},
		{90, {-2051, -1911, -1846, -1754, -1697, -1597, -1395, -997}, 1293, 1323, -203, -1306, 2529}},
};

/* A block of two groups fetches code for both: atlas, 1024 samples, 4.97 and 3.94; but hyq 1.38 and 1.52. */
enum { GROUPS = 2, SPARE_REGISTERS = 24 };

/* Outputs that go through windows have no limbs, whose warps would write elements that stand a sample apart (64 to 4096
   samples, both gradients of hyq, whole matrices: 21 us, through windows 8.6). */

/* Kernels of long functions have the sines of all angles made before their warps part, by all threads, in one loop: a warp
   with 20 sines in its lines fetches the code of each. H100, us, one sample, 32 and 1024, without and with: gradients of
   atlas in f64 15.9 15.9 24.1 and 11.1 11.8 19.1, in f32 8.4 8.4 11.3 and 8.0 8.5 11.0; tau of chain_75 14.1 14.2 25.0 and
   11.1 12.6 20.1, in f64 25.7 25.8 42.4 and 14.4 16.4 25.1; qdd of atlas 6.2 6.3 11.0 and 3.8 4.5 7.8. What is made first
   waits: not so tau of atlas, 2.4 2.5 3.9 and 2.5 3.3 4.4, and tau with vjp of floating hyq in f64, 3.1 3.1 5.9 and 4.1 4.4
   7.6. In f64, where a sine is three times as many instructions, it counts twice: tau of floating g1_29dof 5.7 5.8 8.9 and
   3.4 4.5 6.5. */
enum { FIRST_SINES = 4100, SINE_OPERATIONS = 24 };

/* A wait costs as much as so many operations. With 450 there are fewer waits, but warps make the same values again, and all
   code takes longer to fetch: qdd of floating hyq by four warps, one sample, 5.9 us instead of 3.1. */
enum { JOIN_OPERATIONS = 60 };

/* Of values across: less than a block may ask for. */
enum { ACROSS_BYTES = 2 * SHARED_BYTES };

static const struct code_limits *code_limits(const struct rneagen_options *o)
{
	return &CODE[stage_arithmetic_bytes(o) == 8];
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
		unsigned again = stage_arithmetic_bytes(o) == 8 ? SINE_OPERATIONS * plan_sincos(p) : 0;

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
		.across = ACROSS_BYTES / WARP_THREADS / (unsigned)stage_arithmetic_bytes(o) - 1, .join = JOIN_OPERATIONS,
		.spill = code_limits(o)->spill,
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

	return threads <= BLOCK_THREADS && threads * ((unsigned)s->alive * bytes / 4 + SPARE_REGISTERS) <= REGISTERS &&
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

/* Of several functions side by side, and of limbs that share nothing, nothing is fitted. */
static unsigned most_unfitted(const struct limbs *s, int count)
{
	if (count > 1)
		return MOST_JOINED;
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
	const struct fitted *x = &FITTED[stage_arithmetic_bytes(o) == 8][o->layout == RNEAGEN_AOS];
	long long share = fitted_share(p, plan_alive(&p->plan, a), x);
	unsigned most = LEAST_SAMPLES;

	for (int i = 0; i < BATCHES && x->at[i] + share <= WORTH; i++)
		most = FITTED_BATCHES[i];
	return most;
}

static unsigned most_samples(struct function *const *functions, int count, const struct rneagen_options *o, struct arena *a)
{
	const struct function *p = functions[0];
	int is_fitted = count == 1 && (p->limbs.words || o->layout == RNEAGEN_AOS), is_soa = o->layout == RNEAGEN_SOA;

	if (count == 1 && p->segments.count && gains_little(&p->limbs))
		return MOST_LITTLE;
	if (count == 1 && p->segments.count)
		return is_soa ? MOST_BESIDE : MOST_BESIDE_SEGMENTS_AOS;
	if (count == 1 && is_soa && p->limbs.whole > MOST_FITTED)
		return MOST_BESIDE;
	return is_fitted ? most_fitted(p, o, a) : most_unfitted(&p->limbs, count);
}

/* What all of them have in common. */
static void set_launch(struct function *const *functions, int count, const struct rneagen_options *o, struct arena *a)
{
	int words = words_across(functions, count), groups = most_groups(functions, count, words, (unsigned)stage_arithmetic_bytes(o));
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
	return limbs_spilled(&x->spill, s->alive) + (s->sum > x->room ? (s->sum - x->room) * x->percent / 100 : 0);
}

static unsigned limbs_cost(const struct limbs *s, const struct code_limits *x)
{
	return x->least + s->longest + limbs_excess(s, x);
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
		try_warps(functions[0], MORE_WARPS, MORE_PERCENT, o, a);
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

void limbs_beside_starts(struct limbs *s, const struct rneagen_options *o)
{
	s->most = stage_arithmetic_bytes(o) == 8 && s->first.count ? MOST_BESIDE_STARTS_F64 : MOST_BESIDE_PARTS;
}

void limbs_beside_limbs(struct limbs *s, int parts, const struct rneagen_options *o)
{
	if (parts > 1)
		s->most = MOST_BESIDE_PARTS;
	else
		s->most = o->layout == RNEAGEN_AOS ? MOST_BESIDE_AGAIN_AOS : MOST_BESIDE;
}

void limbs_beside_hands(struct limbs *s, const struct rneagen_options *o)
{
	int is_f64 = stage_arithmetic_bytes(o) == 8;

	if (o->layout == RNEAGEN_AOS)
		s->most = is_f64 ? MOST_BESIDE_HANDS_AOS_F64 : MOST_BESIDE_HANDS_AOS;
	else
		s->most = is_f64 ? MOST_BESIDE : s->whole > LONG_HANDS ? MOST_BESIDE_LONG_HANDS : MOST_LITTLE;
}

void limbs_beside_base(struct limbs *s, const struct rneagen_options *o)
{
	unsigned most = o->layout == RNEAGEN_AOS ? MOST_BESIDE_BASE_AOS : MOST_BESIDE;

	if (s->most < most)
		s->most = most;
}

void limbs_beside_sides(struct limbs *s, const struct rneagen_options *o)
{
	if (o->layout != RNEAGEN_AOS)
		s->most = MOST_BESIDE;
	else
		s->most = stage_arithmetic_bytes(o) == 8 ? MOST_BESIDE_SIDES_AOS_F64 : MOST_BESIDE_SIDES_AOS;
}
