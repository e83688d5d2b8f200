/* What a generated text says about itself: the comment at its head. */
#include "base/number.h"
#include "base/template.h"
#include "emit/emit.h"
#include "emit/kernels/emit_kernel.h"
#include "tree/pattern.h"
#include <string.h>

/* A path's last part. */
static const char *base_name(const char *path)
{
	const char *slash = strrchr(path, '/');

	return slash ? slash + 1 : path;
}

/* Warnings begin with the name of the file: without its folders, so that equal input gives equal bytes. */
static void put_warning(const struct emission *e, const char *warning, struct text *out)
{
	size_t length = strlen(e->options->file);

	if (!strncmp(warning, e->options->file, length))
		warning += base_name(e->options->file) - e->options->file;
	text_put_comment(out, warning);
	text_putc(out, '\n');
}

/* The choices of the scene, as many to a line as there is room for. */
static void put_scene(const struct emission *e, struct text *out)
{
	const struct scene *s = e->scene;
	size_t width = 100, column = width;

	for (int i = 0; i < s->line_count; i++) {
		struct text option;

		if (!adjust_matters(e->adjust, s, i))
			continue;
		text_init(&option, e->arena);
		scene_put_option(&s->lines[i], &option);
		out->failed |= option.failed;
		if (column + option.length >= width) {
			text_put(out, "\n *    ");
			column = strlen(" *    ");
		}
		text_putc(out, ' ');
		text_put_comment(out, text_string(&option));
		column += 1 + option.length;
	}
}

/* A word for the shell, in quotes where it needs them or where `quotes` says so. */
static void put_word(const struct emission *e, const char *word, int quotes, struct text *out)
{
	struct text t;

	text_init(&t, e->arena);
	text_put_shell(&t, word);
	out->failed |= t.failed;
	quotes = quotes && *text_string(&t) != '\'';
	text_put(out, quotes ? "'" : "");
	text_put_comment(out, text_string(&t));
	text_put(out, quotes ? "'" : "");
}

/* The command that makes this text again, every choice spelt out, without paths. */
static void put_command(const struct emission *e, struct text *out)
{
	const struct rneagen_options *o = e->options;

	text_printf(out, "rneagen %s", text_before_file(base_name(o->file)));
	put_word(e, base_name(o->file), 0, out);
	emit_options(o, out);
	if (o->order) {
		text_put(out, " --order ");
		put_word(e, o->order, 1, out);
	}
	text_printf(out, " --name %s", o->name);
	put_scene(e, out);
}

static void put_joint_row(const struct tree_joint *j, struct text *out)
{
	text_printf(out, " *   q[%d", j->iq);
	if (j->nq > 1)
		text_printf(out, "..%d", j->iq + j->nq - 1);
	text_printf(out, "] qd[%d", j->iv);
	if (j->nv > 1)
		text_printf(out, "..%d", j->iv + j->nv - 1);
	text_printf(out, "] %s", joint_type_name(j->type));
	if (*j->name) {
		text_put(out, " \"");
		text_put_comment(out, j->name);
		text_putc(out, '"');
	} else {
		text_put(out, " base");
	}
	text_put(out, j->type == JOINT_PRISMATIC ? ", m\n" : j->nq == 1 ? ", rad\n" : "\n");
}

/* Links that stand, what the equations of motion are then. */
static void put_contacts(const struct emission *e, struct text *out)
{
	const struct request *k = e->request;

	if (k->contact_count)
		text_put(out, " *\n * Links stand: M qdd = tau - bias + J'f, J qdd + dJ/dt qd = 0, with J of\n");
	for (int i = 0; i < k->contact_count; i++) {
		text_put(out, " *   \"");
		text_put_comment(out, k->contacts[i].name);
		text_put(out, k->contacts[i].rows == 6 ? "\", the whole link\n" : "\", its origin\n");
	}
}

static void put_joints(const struct emission *e, struct text *out)
{
	text_put(out, " *\n * Joints:\n");
	for (int i = 0; i < e->tree->joint_count; i++)
		put_joint_row(&e->tree->joints[i], out);
	for (int i = 0; i < e->tree->mimic_count; i++) {
		const struct tree_mimic *m = &e->tree->mimics[i];

		text_put(out, " *   \"");
		text_put_comment(out, m->name);
		text_printf(out, "\" = %.9Lg \"", m->multiplier.x);
		text_put_comment(out, m->driver);
		text_printf(out, "\" + %.9Lg\n", m->offset.x);
	}
}

/* How a pose is written; in which frame a Jacobian is. */
static void put_motion(const struct request *k, const struct want *w, struct text *out)
{
	static const char *const frames[] = {[FRAME_LINK] = "the link's frame", [FRAME_WORLD] = "the world's frame",
		[FRAME_WORLD_ALIGNED] = "the world's axes at the link's origin"};

	if (w->kind == WANT_POSE)
		text_put(out, k->pose == POSE_ROWS ? ": [R p] in the world, row by row"
			: ": p, then a quaternion x y z w, in the world");
	if (w->kind == WANT_DJACOBIAN)
		text_printf(out, ", dJ/dt qd, %s acceleration, in %s",
			k->frame == FRAME_WORLD_ALIGNED ? "a classical" : "a spatial", frames[k->frame]);
	if (w->kind == WANT_JACOBIAN)
		text_printf(out, ": twist = J qd, linear, then angular, in %s", frames[k->frame]);
	if (want_is(w->kind, IS_OPSPACE))
		text_printf(out, w->kind == WANT_OPSPACE ? ", inverse of J Minv J', in %s" : ", J Minv J', in %s",
			frames[k->frame]);
	if (want_is(w->kind, OF_CONTACT))
		text_printf(out, ", what holds it, in %s", frames[k->frame]);
	if (w->kind == WANT_COM || w->kind == WANT_VCOM)
		text_put(out, "in the world");
	if (w->kind == WANT_COM_JACOBIAN || w->kind == WANT_MOMENTUM_MATRIX)
		text_printf(out, "%s = J qd", w->kind == WANT_COM_JACOBIAN ? "vcom" : "momentum");
	if (w->kind == WANT_MOMENTUM || w->kind == WANT_DMOMENTUM)
		text_put(out, " about the centre of mass, in the world's axes");
	if (w->kind == WANT_CORIOLIS)
		text_put(out, "C qd = bias - gravity, dM/dt = C + C'");
}

/* Which elements of a matrix are stored, in their order; only (i, j) with i >= j of M. */
static void put_matrix(const struct emission *e, const struct want *w, struct text *out)
{
	const struct request *k = e->request;
	const char *what = want_is(w->kind, IS_SOLVED) ? "an acceleration" : "a torque";
	int column = 0;
	struct pattern p;

	if (w->kind == WANT_VJP)
		text_printf(out, ": by q, by qd, by %s", k->is_forward ? "tau" : "qdd");
	if (want_is(w->kind, OF_FREED))
		text_printf(out, ": row by row, %s each", what);
	if (w->kind == WANT_REGRESSOR)
		emit_regressor_legend(e, out);
	put_motion(k, w, out);
	if (!request_is_matrix(k, w) || w->kind == WANT_REGRESSOR || w->kind == WANT_POSE)
		return;
	text_put(out, want_is(w->kind, IS_DERIVATIVE) ? ": row by row, " : ": row by row");
	text_put(out, want_is(w->kind, IS_DERIVATIVE) ? what : "");
	text_put(out, want_is(w->kind, IS_DERIVATIVE) ? " each" : "");
	if (!request_pattern(&p, e->tree, w, 0, e->arena) || w->rows == p.lines * p.cols)
		return;
	text_put(out, "; elements");
	for (int i = 0; i < p.lines; i++)
		for (int j = 0; j < p.cols; j++)
			if (p.row[i * p.cols + j] >= 0)
				text_printf(out, "%s%d,%d", column++ % 16 ? " " : "\n *     ", i, j);
}

/* What an array of the scene's is: "payload.hand", and its rows. */
static const char *describe(const struct emission *e, const struct argument *a)
{
	static const char wrench[] = "force, then moment about the link's origin, from outside on the link, in axes of ";
	const struct request *k = e->request;
	struct text t;

	text_init(&t, e->arena);
	emit_product_legend(k, a, &t);
	for (int i = 0; i < k->freed_count; i++)
		if (!a->is_output && !strcmp(a->name, k->freed[i].argument)) {
			text_put_comment(&t, k->freed[i].word);
			text_put(&t, role_rows(a->role) == ROWS_INERTIA
				? ": m hx hy hz Ixx Ixy Ixz Iyy Iyz Izz about the link's origin, in its frame" : "");
			text_put(&t, k->freed[i].kind == FREED_MASS
				? ": kg; the link's centre of mass, and its inertia about that, stay, so h = m c" : "");
			text_put(&t, k->freed[i].kind == FREED_ACCEL
				? ": the acceleration that it has instead of standing, classical; of a weld then its angular one" : "");
			text_put(&t, k->freed[i].body < 0 ? " of each joint with one row, in the rows of qd" : "");
		}
	for (int i = 0; i < k->push_count; i++)
		if (!a->is_output && !strcmp(a->name, k->pushes[i].argument))
			text_printf(&t, "%s%s", wrench, k->in_world ? "the world" : "the link");
	for (int i = 0; i < k->stored_count; i++)
		if (a->is_output && !strcmp(a->name, k->wants[i].argument)) {
			if (strcmp(k->wants[i].word, a->name))
				text_put_comment(&t, k->wants[i].word);
			text_put(&t, role_rows(a->role) == ROWS_WRENCH ? ": linear, then angular" : "");
			put_matrix(e, &k->wants[i], &t);
		}
	return text_string(&t);
}

/* The arrays of a scene's request, in their order. */
static void put_task(const struct emission *e, struct text *out)
{
	const struct dag *d = &emit_main(e)->dag;

	text_put(out, " *\n * Arrays:\n");
	for (int i = 0; i < d->argument_count; i++) {
		const struct argument *a = &d->arguments[i];
		const char *what = describe(e, a);

		text_printf(out, " *   %s %s[%d]%s%s%s\n", a->is_output ? "out" : "in", a->name, a->rows,
			a->per_batch ? ", the same for all samples" : "", *what && *what != ':' ? ": " : "", what);
	}
}

static void put_gravity(const struct emission *e, struct text *out)
{
	const struct request *k = e->request;
	const struct within *g = e->tree->gravity;

	for (int i = 0; i < k->freed_count; i++)
		if (k->freed[i].kind == FREED_GRAVITY) {
			text_put(out, "Gravity, an input, is");
			return;
		}
	for (int i = 0; i < 3; i++)
		text_printf(out, "%s%s", i ? ", " : "Gravity (", number_plain((double)g[i].x).s);
	text_putc(out, ')');
}

static void put_conventions(const struct emission *e, struct text *out)
{
	text_put(out, " *\n * SI units. ");
	put_gravity(e, out);
	text_put(out, e->options->base == RNEAGEN_FLOATING ? " in the world's frame" : " in the world's frame, that of the root link");
	text_printf(out, ". Inputs are finite;\n * where one %sis not, every %s that depends on it is not finite either.\n",
		e->request->is_forward ? "of q, qd and tau " : "", e->request->is_forward ? "acceleration" : "torque");
	if (tree_has_type(e->tree, JOINT_FLOATING))
		text_put(out, " * Floating: q = x y z qx qy qz qw (position and orientation in the parent); qd and qdd = twist in the\n"
			      " * body's frame, linear then angular, and its componentwise derivative (spatial acceleration);\n"
			      " * tau = force then moment about the origin, body's frame. The quaternion is not normalised.\n");
	if (tree_has_type(e->tree, JOINT_PLANAR))
		text_put(out, " * Planar: q = x y theta; x and y in the plane normal to the axis; qd = dq/dt.\n");
	if (emit_has_batches(e))
		text_printf(out, " * Batches: every array is [%s].\n",
			e->options->layout == RNEAGEN_SOA ? "row][sample" : "sample][row");
	text_put(out, e->numbers->note);
	text_put(out, e->target->note);
	if (!e->request->is_plain)
		put_task(e, out);
	for (int i = 0; i < e->function_count; i++)
		if (e->functions[i].algorithm->note)
			text_printf(out, " * %s\n", e->functions[i].algorithm->note);
	emit_legend(e, out);
}

static const char *looped(const struct function *p, const char *columns)
{
	return !dag_loops_go_back(&p->dag) ? columns
		: p->dag.run_count ? "the coordinates beyond a link, and over columns" : "the coordinates beyond a link";
}

static void put_many(const struct function *many, struct text *out)
{
	const struct segments *s = &many->segments;

	text_printf(out, " *   That is with lines for each column of derivatives. Batches run %s: %d segments, each for several\n"
		" *   samples before the next, the last %d of which loop over %s; %d values go across cuts.\n", many->algorithm->name,
		s->count, many->dag.loop_count, looped(many, "such columns"), s->slots[0]);
}

static void put_counts(const struct emission *e, struct text *out)
{
	for (int i = 0; i < e->function_count; i++) {
		struct operation_count n = i ? plan_operations(&e->functions[i].plan)
			: emit_operations(e);

		text_printf(out, " *   %s: %u mul, %u add, %u sub, %u neg, %u fma, %u sincos = %u flops\n",
			e->functions[i].algorithm->name, n.mul, n.add, n.sub, n.neg, n.fma, n.sincos, plan_flops(n));
		if (e->wide)
			text_printf(out,
				" *   %u of these flops in %s: the residual tau - ID(q, qd, qdd), by which the qdd found is refined\n", n.wide,
				e->wide->arithmetic->name);
	}
}

/* How C functions are cut. */
static void put_cuts(const struct emission *e, struct text *out)
{
	for (const struct function *p = e->functions; p < e->functions + e->function_count; p++)
		if (p->segments.count && !p->many && (emit_has_batches(e) || !p->single))
			text_printf(out, " *   %s is in %d segments%s; %d values go across cuts\n", p->algorithm->name, p->segments.count,
				emit_has_batches(e) ? ", each for several samples before the next" : "",
				p->segments.slots[0] + p->segments.slots[1]);
	if (emit_main(e)->many)
		put_many(emit_main(e)->many, out);
	if (emit_main(e)->single)
		text_printf(out, " *   A sample alone runs %s: %d segments, the last %d of which loop over %s.\n",
			emit_main(e)->single->algorithm->name, emit_main(e)->single->segments.count, emit_main(e)->single->dag.loop_count,
			looped(emit_main(e)->single, "columns of derivatives"));
	if (emit_main(e)->beside)
		text_printf(out, " *   With vectors of %d numbers a sample alone runs %s: %d segments in lanes; its last bits may not be\n"
			" *   those of %s. -DRNEA_NO_LANES leaves it out.\n",
			emit_main(e)->beside->dag.width, emit_main(e)->beside->algorithm->name, emit_main(e)->beside->segments.count,
			emit_has_batches(e) ? "a batch" : "a text without");
}

const char *emit_banner(const struct emission *e)
{
	const struct algorithm *x = emit_main(e)->algorithm;
	struct text banner, *out = &banner;

	if (e->banner)
		return e->banner;
	text_init(out, e->arena);
	text_printf(out, "/* %s of \"", x->what);
	text_put_comment(out, e->tree->robot);
	text_printf(out, "\": %s %s.\n", x->doc, x->how);
	text_put(out, " * Generated by rneagen " RNEAGEN_VERSION
		      "; do not edit. Made by\n *   ");
	put_command(e, out);
	text_printf(out, "\n * from a URDF whose SHA-256 is\n *   %s\n", e->hash);
	text_printf(out, " * nq = %d, nv = %d, nb = %d (moving bodies). Operations:\n", e->tree->nq, e->tree->nv,
		e->tree->body_count);
	put_counts(e, out);
	put_cuts(e, out);
	emit_kernels_head(e, out);
	put_contacts(e, out);
	put_joints(e, out);
	text_put(out, e->told ? e->told : "");
	put_conventions(e, out);
	for (size_t i = 0; i < e->warning_count; i++) {
		text_put(out, i ? " *   " : " *\n * Warnings:\n *   ");
		put_warning(e, e->warnings[i], out);
	}
	text_put(out, " */");
	return text_string(out);
}
