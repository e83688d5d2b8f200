/* Any share of the outputs makes a part: the DAG drops what it does not need. */
#include "plan/grid/parts.h"
#include "plan/grid/apart.h"
#include "plan/grid/splitter.h"
#include "plan/lanes/each.h"
#include "plan/stage.h"

/* How many more parts than the best so far are tried. */
enum { LOOK_AHEAD = 6 };

/* Parts in layout aos at most: they cut lines of matrices, and write parts of sectors (H100, gradients of atlas, whole matrices,
   1, 2, 3 and 4 parts, ns: 7.9, 6.6, 9.1 and 9.4, in f64 16.2, 16.6, 17.2 and 18.1; 1024 samples, us: 63, 38, 31 and 32, in f64
   88, 61, 49 and 49). */
enum { PARTS_IN_AOS = 2 };

/* How much more all may cost in a relay with a part more. */
static const double RELAY_LOSS = 1.02;

/* ---- where the parts begin ---- */

/* The first body of a part that ends here, of fullness `most`, with `left` bodies left over for others: by bisection,
   since more bodies fill more. */
static int first_body(struct splitter *s, int end, int left, int most)
{
	int good = end - 1, bad = left - 1;

	while (good - bad > 1) {
		int middle = (good + bad) / 2;

		if (splitter_fullness(s, middle, end) <= most)
			good = middle;
		else
			bad = middle;
	}
	return good;
}

/* From the last body on, `count` parts, each as large as a fullness of `most` allows. first[0] is of the last part. Returns 0
   where they are too few. */
static int split(struct splitter *s, int count, int most, int *first)
{
	int end = s->count;

	for (int made = 0; made < count; made++) {
		first[made] = first_body(s, end, count - made - 1, most);
		if (splitter_fullness(s, first[made], end) > most)
			return 0;
		end = first[made];
	}
	return end == 0;
}

/* So many parts that the fullest is as little full as can be. Returns 0 where there is no such split. */
static int split_evenly(struct splitter *s, int count, int *first)
{
	int bad = 0, good = splitter_fullness(s, 0, s->count);

	/* alone, what a part has in common with others may be a little more than in the whole */
	if (!split(s, count, good, first))
		good = MOST;
	while (good - bad > 1) {
		int middle = (good + bad) / 2;

		if (split(s, count, middle, first))
			good = middle;
		else
			bad = middle;
	}
	return split(s, count, good, first);
}

static double cost_of_split(struct splitter *s, int count, const int *first)
{
	double sum = 0;

	for (int i = 0, end = s->count; i < count; end = first[i++])
		sum += splitter_cost(s, first[i], end);
	return sum;
}

/* In aos, where the arrays have room in shared memory, each block writes whole samples. */
static int may_have(const struct splitter *s)
{
	return s->x->options->layout == RNEAGEN_SOA || !stage_fits(&s->x->whole->dag, s->x->options);
}

/* Operations of the longest of so many parts; 0 where there is no such split. */
static int longest_of(struct splitter *s, int count, int *first)
{
	int longest = 0;

	if (count > 1 && !split_evenly(s, count, first))
		return 0;
	for (int i = 0, end = s->count; i < count; end = first[i++]) {
		int operations = splitter_size(s, count > 1 ? first[i] : 0, end)->operations;

		longest = operations > longest ? operations : longest;
	}
	return longest;
}

/* In a relay one part more serves small batches, if the longest gets shorter, and all cost hardly more. H100, both gradients of
   qdd of atlas in f32, 3, 4 and 5 parts: 1024 samples 35.9, 33.8 and 37.5 us; 262144 samples 4.66, 4.71 and 4.82 ns. */
static int is_one_more(struct splitter *s, int best, double least, int *first)
{
	int longest, divided;

	if (!s->x->is_relayed || best >= s->count)
		return 0;
	longest = longest_of(s, best, first);
	divided = longest_of(s, best + 1, first);
	return divided && 10 * divided <= 9 * longest && cost_of_split(s, best + 1, first) <= RELAY_LOSS * least;
}

/* As many parts as cost least. One more need not cost less where a few more do: only when all fit is nothing lost. */
static int choose_count(struct splitter *s, int *first)
{
	double least = splitter_cost(s, 0, s->count);
	int best = 1;

	if (splitter_fullness(s, 0, s->count) <= FULL || !splitter_can_gain(s) || !may_have(s))
		return 1;
	for (int count = 2; count <= s->count && count <= best + LOOK_AHEAD; count++) {
		double cost = split_evenly(s, count, first) ? cost_of_split(s, count, first) : least;

		if (cost < least) {
			least = cost;
			best = count;
		}
	}
	best += is_one_more(s, best, least, first);
	return s->x->options->layout == RNEAGEN_AOS && best > PARTS_IN_AOS ? PARTS_IN_AOS : best;
}

int part_plan(struct part *p, const char *name, const char *doc, const struct parts_of *x, struct arena *a)
{
	p->algorithm = (struct algorithm){.name = name, .doc = doc};
	p->function.algorithm = &p->algorithm;
	if (!plan_build(&p->function.plan, &p->function.dag, x->tree, a))
		return 0;
	p->alive = plan_alive(&p->function.plan, a);
	return !a->failed;
}

int part_build(
	struct part *p, const struct dag *raw, const char *name, const char *doc, const struct parts_of *x, struct arena *a)
{
	dag_init(&p->function.dag, a);
	dag_fuse(&p->function.dag, raw, x->options->strict);
	return part_plan(p, name, doc, x, a);
}

int part_build_share(struct part *p, struct share *share, int first, int end, const char *name, const char *doc,
	const struct parts_of *x, struct arena *a)
{
	struct arena spare;
	struct dag raw;
	int is_built;

	arena_init(&spare, x->options->allocator);
	share_copy(share, first, end, &raw, &spare);
	is_built = part_build(p, &raw, name, doc, x, a);
	arena_free(&spare);
	return is_built;
}

int part_order(struct part *p, enum plan_ordered what, const struct parts_of *x, struct arena *a)
{
	if (!plan_order(&p->function, x->tree, x->request, x->options, what, a))
		return 0;
	p->alive = plan_alive(&p->function.plan, a);
	return !a->failed;
}

static int make_part(struct splitter *s, int number, int first, int end, struct part *p)
{
	struct text name, doc;

	p->first = s->owners.bodies[first];
	p->last = s->owners.bodies[end - 1];
	text_init(&name, s->a);
	text_init(&doc, s->a);
	text_printf(&name, "%s_part%d", s->x->whole->algorithm->name, number);
	text_printf(&doc, "Part %d of it: elements of matrices by the joints of links %d to %d%s.", number,
		s->x->tree->bodies[p->first].number, s->x->tree->bodies[p->last].number,
		first ? "" : ", and all that is no matrix");
	return part_build_share(p, &s->share, first, end, text_string(&name), text_string(&doc), s->x, s->a) && !name.failed &&
	       !doc.failed;
}

/* ---- the whole ---- */

static int begin(struct splitter *s)
{
	if (!owners_make(&s->owners, s->x->raw, s->x->tree, s->x->request, !s->x->is_relayed, s->a))
		return 0;
	s->count = s->owners.count;
	s->sizes = arena_alloc(s->a, (size_t)(s->count + 1) * (size_t)(s->count + 1), sizeof *s->sizes);
	if (!s->sizes)
		return 0;
	s->sizes[s->count] = splitter_plan_size(&s->x->whole->plan, s->a); /* from the first to the last: that is made already */
	return share_begin(&s->share, s->x->raw, s->owners.owner, s->a) && !s->a->failed;
}

/* Why a text cannot be in parts; NULL: it can. */
static const char *obstacle(const struct request *k, int has_kernels)
{
	if (!has_kernels)
		return "is for kernels: take --target cuda";
	if (!owners_matrix(k))
		return "is for matrices: name one in --want, such as dtau_dq, M or dqdd_dq";
	return NULL;
}

/* Returns how many parts there are, 0 after an error; first[0] is where the last of them begins, if there are several. */
static int choose(struct splitter *s, int *first, struct rneagen_error *e)
{
	int count = s->x->options->parts == RNEAGEN_PARTS_AUTO ? choose_count(s, first) : s->x->options->parts;

	if (count == 1 || (count <= s->count && split_evenly(s, count, first)))
		return count;
	error_set(e, RNEAGEN_USAGE, "--parts %d: there are elements of %d bodies to share out; take fewer, or auto",
		count, s->count);
	return 0;
}

static struct part *make_parts(struct splitter *s, int count, const int *first)
{
	struct part *parts = arena_alloc(s->a, (size_t)count, sizeof *parts);

	for (int i = 0; i < count && parts; i++)
		if (!make_part(s, i, first[count - 1 - i], i + 1 < count ? first[count - 2 - i] : s->count, &parts[i]))
			return NULL;
	return parts;
}

enum rneagen_code parts_make(struct part **parts, int *count, const struct parts_of *x, struct arena *a, struct rneagen_error *e)
{
	const struct rneagen_options *o = x->options;
	struct splitter s = {.x = x, .a = a};
	const char *why = obstacle(x->request, x->has_kernels);
	int least = x->is_relayed ? 1 : 2;
	int made, *first;

	*count = 0;
	if (o->parts == RNEAGEN_PARTS_AUTO && why)
		return apart_make(parts, count, x, a) ? RNEAGEN_OK : error_memory(e);
	if (o->parts == 1)
		return RNEAGEN_OK;
	if (why)
		return error_set(e, RNEAGEN_USAGE, "--parts %d %s", o->parts, why);
	first = arena_alloc(a, (size_t)x->tree->body_count, sizeof *first);
	if (!first || !begin(&s))
		return error_memory(e);
	made = choose(&s, first, e);
	if (e->code)
		return e->code;
	if (made == 1)
		first[0] = 0;
	*parts = made >= least ? make_parts(&s, made, first) : NULL;
	if (s.failed || (made >= least && !*parts))
		return error_memory(e);
	*count = made >= least ? made : 0;
	parts_divide(*parts, *count, DIVIDED_BY_COLUMNS);
	return RNEAGEN_OK;
}

void parts_divide(struct part *parts, int count, enum division division)
{
	for (int i = 0; i < count; i++)
		parts[i].division = division;
}

int parts_alive(const struct part *parts, int count)
{
	int most = 0;

	for (int i = 0; i < count; i++)
		most = parts[i].alive > most ? parts[i].alive : most;
	return most;
}

struct operation_count part_operations(const struct part *p)
{
	return p->function.each ? each_operations(p->function.each) : plan_operations(&p->function.plan);
}

struct operation_count parts_operations(const struct part *parts, int count, const struct plan *whole)
{
	struct operation_count sum = {0};

	if (!count)
		return plan_operations(whole);
	for (int i = 0; i < count; i++)
		plan_add_operations(&sum, part_operations(&parts[i]), 1);
	return sum;
}

void parts_dump(const struct part *parts, int count, const struct function *whole, const struct tree *t, struct text *out)
{
	if (!count)
		text_printf(out, "whole: %u flops\n", plan_flops(plan_operations(&whole->plan)));
	for (int i = 0; i < count; i++) {
		text_printf(out, "part %d: links %d..%d, %u flops, %d values at once", i, t->bodies[parts[i].first].number,
			t->bodies[parts[i].last].number, plan_flops(part_operations(&parts[i])), parts[i].alive);
		if (parts[i].joints)
			text_printf(out, ", motion made again by stretches of at most %d joints", parts[i].joints);
		if (parts[i].function.each)
			text_printf(out, ", alike limbs in %d loops", parts[i].function.each->loops->count);
		text_putc(out, '\n');
	}
}
