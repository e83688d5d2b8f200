#include "plan/stage.h"

int stage_number_bytes(const struct rneagen_options *o)
{
	return o->precision == RNEAGEN_F32 || o->precision == RNEAGEN_MIXED ? 4 : 8;
}

int stage_arithmetic_bytes(const struct rneagen_options *o)
{
	return o->precision == RNEAGEN_F32 ? 4 : 8;
}

int stage_is_plain(const struct rneagen_options *o)
{
	return o->precision == RNEAGEN_F32 || o->precision == RNEAGEN_F64;
}

int stage_place(const struct dag *d, int argument)
{
	int qdd = dag_find_role(d, ROLE_JOINT_ACCELERATION, 0), tau = dag_find_role(d, ROLE_JOINT_TORQUE, 1);

	return qdd >= 0 && tau >= 0 && argument == tau ? qdd : argument;
}

int stage_has_place(const struct dag *d, int argument)
{
	return !d->arguments[argument].per_batch && stage_place(d, argument) == argument;
}

static int gcd(int a, int b)
{
	return b ? gcd(b, a % b) : a;
}

/* 32 banks of 4 bytes: even eight threads on a bank are cheaper than a gap that breaks the slice up (H100: hyq, 12 rows,
   0.93 of the floor instead of 0.78). */
int stage_pitch(int rows, const struct rneagen_options *o)
{
	return o->layout == RNEAGEN_SOA || gcd(rows, 128 / stage_number_bytes(o)) <= 8 ? rows : rows | 1;
}

int stage_words(const struct dag *d, const struct rneagen_options *o)
{
	int words = 0;

	for (int i = 0; i < d->argument_count; i++)
		if (stage_has_place(d, i))
			words += stage_pitch(d->arguments[i].rows, o);
	return words;
}

/* In aos, to move whole lines, wherever 32 samples have room; in soa in arithmetic of 8 bytes, where inputs that wait in
   registers leave few threads, as long as 64 have (H100: iiwa14 0.96 of the floor instead of 0.86, fetch 0.94 instead of 0.80;
   but jvrc1, where 32 just fit, 0.47 instead of 0.63; floating, ps, by segments and with 32: atlas 714, 617, g1_29dof 708, 693,
   but 131072 samples 718, 790, simple_humanoid 404, 430, jvrc1 715, 974). */
int stage_has_room(int words, const struct rneagen_options *o)
{
	int bytes = WARP_THREADS * words * stage_number_bytes(o);

	if (o->layout == RNEAGEN_AOS)
		return bytes <= SHARED_BYTES;
	return o->precision != RNEAGEN_F32 && 2 * bytes <= SHARED_BYTES;
}

int stage_fits(const struct dag *d, const struct rneagen_options *o)
{
	return stage_has_room(stage_words(d, o), o);
}

int output_is_zero(const struct dag *d, const struct output *o)
{
	const struct node *n = &d->nodes[o->value.i];

	return n->op == OP_CONST && n->value == 0;
}

/* ---- windows ---- */

/* Bytes of a warp's window at most. Where many values wait, larger ones leave too few warps. H100, 262144 samples, ps, whole
   matrices, windows of 176, 260 and of 88, 116, 172 slots: gradients of atlas in 2 parts 6700, 6560, in f64 17200, 16600, 19800;
   M of atlas with 176 and 270 slots, all of it, 2410 and 1600; in f64 with 86 and 176, 6160 and 3500. */
enum { WINDOW_BYTES = SHARED_BYTES - 1024, WINDOW_BYTES_FULL = 35 << 10 };

/* More values that wait fill the registers. */
enum { FULL_SINGLE = 200, FULL_DOUBLE = 125 };

/* Elements of outputs, such as a humanoid's regressor, beyond which nothing was measured. */
enum { MOST_ELEMENTS = 8192 };

/* Bytes of a warp's staged arrays beyond which there are windows. */
enum { STAGED_BYTES = 40 << 10 };

/* Not worth a flush: fewer than one slot in so many. */
enum { LEAST_FREED = 8 };

/* A row of an output on its way. Rows of all outputs come one after the other. */
struct element {
	int argument, row;
	int is_output, is_zero;
	int slot;
	int flush; /* in the order of all functions; -1: it did not leave yet */
};

struct maker {
	struct function *const *functions;
	int count, slots, line;
	int first[DAG_ARGUMENTS]; /* element of each argument */
	struct element *elements;
	int element_count;
	int *left;        /* per line: elements that are not there yet; by its first element */
	int *held, held_count;
	int *free, free_count;
	int flush_count;  /* of all functions so far */
	struct arena *a;
};

static struct element *element_of(const struct maker *m, const struct output *o)
{
	return &m->elements[m->first[o->argument] + o->row];
}

static int *left_of(const struct maker *m, const struct element *x)
{
	return &m->left[m->first[x->argument] + x->row / m->line * m->line];
}

static int begin(struct maker *m)
{
	const struct dag *d = &m->functions[0]->dag;

	for (int i = 0; i < d->argument_count; i++) {
		m->first[i] = m->element_count;
		m->element_count += d->arguments[i].is_output ? d->arguments[i].rows : 0;
	}
	m->elements = arena_alloc(m->a, (size_t)m->element_count + 1, sizeof *m->elements);
	m->left = arena_alloc(m->a, (size_t)m->element_count + 1, sizeof *m->left);
	m->held = arena_alloc(m->a, (size_t)m->slots + 1, sizeof *m->held);
	m->free = arena_alloc(m->a, (size_t)m->slots + 1, sizeof *m->free);
	if (m->a->failed)
		return 0;
	for (int k = 0; k < m->count; k++) {
		const struct dag *part = &m->functions[k]->dag;

		for (size_t i = 0; i < part->output_count; i++) {
			const struct output *o = &part->outputs[i];

			*element_of(m, o) = (struct element){.argument = o->argument, .row = o->row, .is_output = 1,
				.is_zero = output_is_zero(part, o), .flush = -1};
		}
	}
	return 1;
}

/* What is held leaves; of incomplete lines only where `all` does. Returns the slots that are free then. */
static int leave(struct maker *m, int all)
{
	int kept = 0;

	for (int i = 0; i < m->held_count; i++) {
		struct element *x = &m->elements[m->held[i]];

		if (all || *left_of(m, x) == 0) {
			x->flush = m->flush_count;
			m->free[m->free_count++] = x->slot;
		} else {
			m->held[kept++] = m->held[i];
		}
	}
	m->held_count = kept;
	return m->free_count;
}

static void flush(struct maker *m, int all)
{
	if (leave(m, all) * LEAST_FREED < m->slots)
		leave(m, 1);
	m->flush_count++;
}

/* In the order in which the statements store. */
static int assign(struct maker *m, struct function *p)
{
	const struct plan *plan = &p->plan;
	struct windows *w = &p->windows;
	int from = m->flush_count;

	*w = (struct windows){.slots = m->slots, .slot = arena_alloc(m->a, p->dag.output_count + 1, sizeof *w->slot),
		.before = arena_alloc(m->a, p->dag.output_count + 1, sizeof *w->before)};
	if (m->a->failed)
		return 0;
	for (size_t i = 0; i < p->dag.output_count; i++)
		if (!output_is_zero(&p->dag, &p->dag.outputs[i]))
			++*left_of(m, element_of(m, &p->dag.outputs[i]));
	for (m->free_count = 0; m->free_count < m->slots; m->free_count++)
		m->free[m->free_count] = m->slots - 1 - m->free_count;
	for (size_t i = 0; i < plan->line_count; i++) {
		size_t n = plan->lines[i].index;
		struct element *x;

		if (plan->lines[i].kind != LINE_STORE)
			continue;
		x = element_of(m, &p->dag.outputs[n]);
		w->slot[n] = -1;
		if (x->is_zero)
			continue;
		if (!m->free_count) {
			flush(m, 0);
			w->before[n] = m->flush_count - from;
		}
		x->slot = w->slot[n] = m->free[--m->free_count];
		m->held[m->held_count++] = (int)(x - m->elements);
		--*left_of(m, x);
	}
	flush(m, 1);
	w->flush_count = m->flush_count - from;
	return 1;
}

/* Zeros leave with the neighbour that leaves last. */
static void join_zeros(struct maker *m)
{
	for (int i = 0, end; i < m->element_count; i = end) {
		const struct element *x = m->elements;
		int last = 0;

		end = i + 1;
		if (!x[i].is_zero)
			continue;
		while (end < m->element_count && x[end].is_zero && x[end].argument == x[i].argument)
			end++;
		if (i > 0 && x[i - 1].argument == x[i].argument)
			last = x[i - 1].flush;
		if (end < m->element_count && x[end].argument == x[i].argument && x[end].flush > last)
			last = x[end].flush;
		for (int k = i; k < end; k++) {
			m->elements[k].flush = last;
			m->elements[k].slot = m->slots;
		}
	}
}

static int follows(const struct element *x)
{
	return x[-1].is_output && x[-1].argument == x->argument && x[-1].flush == x->flush;
}

static void make_flush(const struct maker *m, int number, struct window_flush *f)
{
	int *slots, n = 0, count = 0;

	for (int i = 0; i < m->element_count; i++)
		count += m->elements[i].is_output && m->elements[i].flush == number;
	f->runs = arena_alloc(m->a, (size_t)count + 1, sizeof *f->runs);
	slots = arena_alloc(m->a, (size_t)count + 1, sizeof *slots);
	if (m->a->failed)
		return;
	for (int i = 0; i < m->element_count; i++) {
		const struct element *x = &m->elements[i];

		if (!x->is_output || x->flush != number)
			continue;
		if (i == 0 || !follows(x))
			f->runs[f->count++] = (struct window_run){.argument = x->argument, .row = (unsigned)x->row, .slots = slots + n};
		f->runs[f->count - 1].count++;
		slots[n++] = x->slot;
	}
}

static int make_flushes(struct maker *m)
{
	int number = 0;

	for (int k = 0; k < m->count; k++) {
		struct windows *w = &m->functions[k]->windows;

		w->flushes = arena_alloc(m->a, (size_t)w->flush_count, sizeof *w->flushes);
		for (int i = 0; i < w->flush_count && !m->a->failed; i++)
			make_flush(m, number++, &w->flushes[i]);
	}
	return !m->a->failed;
}

/* Elements that a function stores at most, as far as there is room. */
static int slots_for(struct function *const *functions, int count, const struct rneagen_options *o, struct arena *a)
{
	int most = 0, alive = 0, bytes = stage_number_bytes(o), room;

	for (int i = 0; i < count; i++) {
		const struct dag *d = &functions[i]->dag;
		int stored = 0, waiting = plan_alive(&functions[i]->plan, a);

		for (size_t n = 0; n < d->output_count; n++)
			stored += !output_is_zero(d, &d->outputs[n]);
		most = stored > most ? stored : most;
		alive = waiting > alive ? waiting : alive;
	}
	room = (alive > (bytes == 4 ? FULL_SINGLE : FULL_DOUBLE) ? WINDOW_BYTES_FULL : WINDOW_BYTES) / (WINDOW_PITCH * bytes) - 1;
	return most < room ? most : room;
}

/* Is it better to stage all arrays than to have windows? H100, whole gradients, ps, staged and by windows: iiwa14 194 and 300, in
   f64, 32 KB for a warp, 378 and 450; but of hyq in f32, 41 KB, 745 and 530. */
int stage_holds_all(const struct dag *d, const struct rneagen_options *o)
{
	return stage_fits(d, o) && WARP_THREADS * stage_words(d, o) * stage_number_bytes(o) <= STAGED_BYTES;
}

/* More than a torque for each joint. */
static int is_many(struct function *const *functions, int count)
{
	size_t elements = 0;

	for (int i = 0; i < count; i++)
		elements += functions[i]->dag.output_count;
	return elements > (size_t)functions[0]->plan.tree->nv && elements <= MOST_ELEMENTS;
}

int windows_choose(struct function *const *functions, int count, const struct rneagen_options *o, struct arena *a)
{
	struct maker m = {.functions = functions,
		.count = count,
		.line = functions[0]->plan.tree->nv > 0 ? functions[0]->plan.tree->nv : 1,
		.a = a};
	int done;

	if (o->layout != RNEAGEN_AOS || functions[0]->segments.count || !is_many(functions, count))
		return 1;
	m.slots = slots_for(functions, count, o, a);
	if (count == 1 && stage_holds_all(&functions[0]->dag, o))
		return 1;
	done = m.slots == 0 || begin(&m);
	for (int i = 0; i < count && done && m.slots; i++)
		done = assign(&m, functions[i]);
	if (!done || !m.slots)
		return done;
	join_zeros(&m);
	return make_flushes(&m);
}
