#include "plan/tiles/tiles.h"
#include "base/error.h"
#include "plan/grid/places.h"
#include "plan/stage.h"

/* Operations beyond which other texts have such kernels, in f32 and in f64. */
enum { LEAST_SINGLE = 1400, LEAST_DOUBLE = 2000 };

/* Bytes of a sample with a vjp at most, of one part and of the only one: ptxas leaves room for no more than 640 of a thread, for
   what no register holds among them. */
enum { PRODUCT_BYTES = 560, ALONE_BYTES = 640 };

/* The same of inputs alone, where the rows of a part that shares nothing with others cannot leave as tiles: more of them pay
   where the part, with so many operations, would be longer than the instruction cache without; and values at once of one in
   f32. H200, ps for each of a million samples, without and with: 656 bytes, of the vjp of accelerations of floating atlas,
   4630 and 4260, but 1104 bytes, 4890 and 5170; of tau and vjp, 720 bytes, 5409 operations, 1010 and 1070, 1040 bytes, 6447
   operations, 1710 and 1220; in f32, 568 bytes, 389 values at once, 1570 and 2370. */
enum { INPUT_BYTES = 700, INPUT_BYTES_LONG = 1100, INPUT_LONG = 6200, INPUT_ALIVE = 220 };

/* Values at once of accelerations in f32, beyond which they would spill, and tiles take the room. */
enum { FULL_FORWARD = 220 };

/* Threads of a block: H100, ps of 4 M samples in blocks of 32, 64 and 128, tau with vjp in f32 of atlas 385, 346, 345, of
   g1_29dof 397, 349, 349; in f64 of g1_29dof 722, 714, 742. What a kernel has beside the tiles. */
enum { MOST_THREADS = 64, OTHER_BYTES = 1024 };

/* The first function, or its parts, which are to have tiles. */
struct chosen {
	struct function *whole;
	struct part *parts;
	int count;
	const struct parts_of *of;
};

/* Rows of a tile at most. */
enum { MOST_ROWS = 256 };

static int are_short(const struct stretches *s, const struct dag *d)
{
	for (int i = 0; i < d->argument_count; i++)
		for (int k = 0; k < STRETCHES; k++)
			if (s->own[i][k].rows > MOST_ROWS)
				return 0;
	return 1;
}

/* Bytes of a sample of a product. */
static int most_bytes(const struct function *p, const struct stretches *s, const struct chosen *x)
{
	if (!s->has_inputs_alone)
		return x->count > 1 ? PRODUCT_BYTES : ALONE_BYTES;
	if (!parts_are_apart(x->parts, x->count))
		return SHARED_BYTES;
	return plan_flops(plan_operations(&p->plan)) > INPUT_LONG ? INPUT_BYTES_LONG : INPUT_BYTES;
}

/* Where they have room. */
static void set(struct function *p, const struct stretches *s, const struct chosen *x)
{
	int bytes = stretches_words(s, &p->dag, x->of->options) * stage_number_bytes(x->of->options);

	if (!are_short(s, &p->dag) || !tiles_block(bytes))
		return;
	if (request_wants_derivative(x->of->request) && bytes > most_bytes(p, s, x))
		return;
	p->tiles = s;
}

/* A part of matrices, or one whose outputs cannot leave so: its rows of inputs. */
static int set_inputs(struct function *p, const struct chosen *x, struct arena *a)
{
	struct stretches *s = arena_alloc(a, 1, sizeof *s);

	if (!s)
		return 0;
	stretches_make_inputs(s, &p->dag);
	set(p, s, x);
	return 1;
}

/* Is every row that leaves written, and nothing written over before it is read? */
static int serve(int *serves, const struct function *p, const struct stretches *s, struct arena *a)
{
	if (!places_serve(serves, p, s, a))
		return 0;
	*serves = *serves && stretches_are_written(s, &p->dag);
	return 1;
}

/* What has all rows of each array. */
static int set_whole(struct function *p, const struct chosen *x, struct arena *a)
{
	struct stretches *s = arena_alloc(a, 1, sizeof *s);
	int serves;

	if (!s)
		return 0;
	stretches_make_whole(s, &p->dag, 0);
	if (!serve(&serves, p, s, a))
		return 0;
	if (serves)
		set(p, s, x);
	return 1;
}

/* What the copy engine moves must be each sample's own, in numbers of the arithmetic. */
static int may_have(const struct chosen *x)
{
	const struct rneagen_options *o = x->of->options;
	const struct dag *d = &x->whole->dag;

	if (!x->of->has_kernels || o->layout != RNEAGEN_SOA || x->of->request->refine_steps || !stage_is_plain(o))
		return 0;
	for (int i = 0; i < d->argument_count; i++)
		if (d->arguments[i].per_batch)
			return 0;
	return 1;
}

static int is_by_row(const struct chosen *x)
{
	const struct dag *d = &x->whole->dag;

	for (size_t i = 0; i < d->output_count; i++)
		if (!parts_is_by_row(&d->arguments[d->outputs[i].argument], x->of->tree->nv))
			return 0;
	return 1;
}

static int is_long(const struct chosen *x)
{
	unsigned operations = plan_flops(parts_operations(x->parts, x->count, &x->whole->plan));

	if (x->count && !parts_are_apart(x->parts, x->count))
		return operations > TILES_COLUMNS;
	return operations > (x->of->options->precision == RNEAGEN_F32 ? LEAST_SINGLE : LEAST_DOUBLE);
}

static int has_room(const struct chosen *x, struct arena *a)
{
	return !x->of->request->is_forward || x->of->options->precision != RNEAGEN_F32 || plan_alive(&x->whole->plan, a) <= FULL_FORWARD;
}

/* A part that shares nothing with others. */
static int choose_apart(struct function *p, const struct chosen *x, struct arena *a)
{
	int serves;

	if (!serve(&serves, p, p->stretches, a))
		return 0;
	if (serves)
		set(p, p->stretches, x);
	return 1;
}

static void drop(const struct chosen *x)
{
	x->whole->tiles = NULL;
	for (int i = 0; i < x->count; i++)
		x->parts[i].function.tiles = NULL;
}

/* Rows of a product that stand between rows of other parts leave by themselves, as those of matrices do. */
static int may_have_inputs(const struct part *p, const struct chosen *x)
{
	if (!parts_are_apart(x->parts, x->count))
		return 1;
	return request_wants_derivative(x->of->request) && (x->of->options->precision == RNEAGEN_F64 || p->alive <= INPUT_ALIVE);
}

static int choose_parts(const struct chosen *x, struct arena *a)
{
	int are_apart = parts_are_apart(x->parts, x->count);

	for (int i = 0; i < x->count; i++) {
		struct function *p = &x->parts[i].function;

		if (are_apart && !choose_apart(p, x, a))
			return 0;
		if (!p->tiles && may_have_inputs(&x->parts[i], x) && !set_inputs(p, x, a))
			return 0;
	}
	return 1;
}

/* ---- tensor maps ---- */

int tiles_find(const struct tiles *t, int argument, int rows)
{
	int i = 0;

	while (i < t->count && (t->list[i].argument != argument || t->list[i].rows != rows))
		i++;
	return i;
}

static int add(struct tiles *t, int argument, int rows)
{
	int at = tiles_find(t, argument, rows);

	if (at == TILES_LIMIT)
		return 0;
	t->list[at].argument = argument;
	t->list[at].rows = rows;
	t->count += at == t->count;
	return 1;
}

int tiles_add(struct tiles *t, const struct function *p)
{
	for (int i = 0; p->tiles && i < p->dag.argument_count; i++)
		for (int k = 0; k < STRETCHES; k++)
			if (p->tiles->own[i][k].rows && !add(t, i, p->tiles->own[i][k].rows))
				return 0;
	return 1;
}

/* Not where a launch would function on too many. */
static void bound_maps(const struct chosen *x)
{
	struct tiles t = {.count = 0};
	int has_room = tiles_add(&t, x->whole);

	for (int i = 0; i < x->count; i++)
		has_room = has_room && tiles_add(&t, &x->parts[i].function);
	if (!has_room)
		drop(x);
}

static int choose(const struct chosen *x, struct arena *a)
{
	if (!may_have(x) || !is_long(x))
		return 1;
	if (x->count)
		return (x->count == 1 && !parts_are_apart(x->parts, 1)) || choose_parts(x, a);
	return !is_by_row(x) || !has_room(x, a) || set_whole(x->whole, x, a);
}

enum rneagen_code tiles_choose(struct function *whole, struct part *parts, int count, const struct parts_of *of, struct arena *a,
	struct rneagen_error *e)
{
	const struct chosen x = {whole, parts, count, of};

	if (!choose(&x, a))
		return error_memory(e);
	bound_maps(&x);
	return RNEAGEN_OK;
}

int tiles_words(const struct function *p, const struct rneagen_options *o)
{
	return stretches_words(p->tiles, &p->dag, o);
}

int tiles_block(int bytes)
{
	for (int threads = MOST_THREADS; threads >= WARP_THREADS; threads /= 2)
		if (threads * bytes <= SHARED_BYTES - OTHER_BYTES)
			return threads;
	return 0;
}

int tiles_are_inputs(const struct function *p)
{
	return p->tiles != NULL && p->tiles->has_inputs_alone;
}

const struct stretches *tiles_rows(const struct function *p)
{
	return tiles_are_inputs(p) ? p->tiles : p->stretches;
}

int tiles_divide_q(const struct function *p)
{
	const struct stretches *s = tiles_rows(p);

	return s && s->own[0][1].rows > 0;
}
