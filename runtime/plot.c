#include "plot.h"
#include "child.h"
#include "emit.h"
#include "pending.h"
#include "scratch.h"
#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDTH = 1000, HEIGHT = 650 };

/* Errors below are as good as none; logarithms are to base 10. */
#define LEAST_ERROR 1e-17

struct point {
	const struct study_row *row;
	double x, y;       /* log of the error, and of samples per second */
	double label_y;
};

struct plot {
	const struct report *report;
	struct point *points, *front; /* by speed; on the front: what no other variant of the backend beats in both */
	size_t count, front_count, batch;
	double x[2], y[2]; /* ranges of the axes */
};

/* ---- points ---- */

static int by_speed(const void *a, const void *b)
{
	const struct point *p = a, *q = b;

	return p->y != q->y ? (p->y > q->y) - (p->y < q->y) : (p->x > q->x) - (p->x < q->x);
}

static int take_points(struct plot *p)
{
	const struct report *r = p->report;

	p->points = calloc(r->count + 1, sizeof *p->points);
	p->front = calloc(r->count + 1, sizeof *p->front);
	for (size_t i = 0; i < r->count; i++)
		p->batch = r->rows[i].batch > p->batch ? r->rows[i].batch : p->batch;
	for (size_t i = 0; p->points && i < r->count; i++) {
		const struct study_row *row = &r->rows[i];

		if (row->batch == p->batch && isfinite(row->errors.max))
			p->points[p->count++] = (struct point){.row = row, .x = log10(fmax(row->errors.max, LEAST_ERROR)),
				.y = log10(1e9 / row->ns)};
	}
	if (p->points)
		qsort(p->points, p->count, sizeof *p->points, by_speed);
	return p->points && p->front;
}

static int is_beaten(const struct plot *p, const struct point *a)
{
	for (size_t i = 0; i < p->count; i++) {
		const struct point *b = &p->points[i];

		if (b->row->backend == a->row->backend && b->x <= a->x && b->y >= a->y && (b->x < a->x || b->y > a->y))
			return 1;
	}
	return 0;
}

static void take_front(struct plot *p)
{
	for (size_t i = 0; i < p->count; i++)
		if (!is_beaten(p, &p->points[i]))
			p->front[p->front_count++] = p->points[i];
}

static void set_ranges(struct plot *p)
{
	p->x[0] = p->y[0] = (double)INFINITY;
	p->x[1] = p->y[1] = -(double)INFINITY;
	for (size_t i = 0; i < p->count; i++) {
		p->x[0] = fmin(p->x[0], p->points[i].x - 2.5);
		p->x[1] = fmax(p->x[1], p->points[i].x + 1);
		p->y[0] = fmin(p->y[0], p->points[i].y - 0.2);
		p->y[1] = fmax(p->y[1], p->points[i].y + 0.3);
	}
}

/* ---- labels ---- */

/* A label stands left of its point on the front and above it, where no other point of the backend is nor the line that joins
   them, and above the labels that it would cover. */
static void place_labels(struct plot *p)
{
	double line = 0.03 * (p->y[1] - p->y[0]), width = 0.2 * (p->x[1] - p->x[0]);

	for (size_t i = 0; i < p->front_count; i++) {
		struct point *q = &p->front[i];

		q->label_y = q->y + line;
		for (size_t k = 0; k < i; k++)
			if (fabs(p->front[k].x - q->x) < width)
				q->label_y = fmax(q->label_y, p->front[k].label_y + line);
		p->y[1] = fmax(p->y[1], q->label_y + 2 * line);
	}
}

/* ---- the script ---- */

/* What gnuplot could take for more than text is left out. */
static void put_name(FILE *f, const char *name)
{
	for (; *name; name++)
		fputc(isalnum((unsigned char)*name) || strchr(" .-_", *name) ? *name : ' ', f);
}

static void put_label(const struct plot *p, const struct point *q, FILE *f)
{
	double x = pow(10, q->x - 0.012 * (p->x[1] - p->x[0])), y = pow(10, q->label_y);
	const struct study_row *r = q->row;

	fprintf(f, "set label '%s %s %s' at %.9g,%.9g right noenhanced\n", emit_precision_name(r->precision), emit_trig_name(r->trig),
		emit_layout_name(r->layout), x, y);
	fprintf(f, "set arrow from %.9g,%.9g to %.9g,%.9g nohead back lc rgb '#c0c0c0' lw 0.5\n", pow(10, q->x), pow(10, q->y), x, y);
}

static void put_data(const struct point *points, size_t count, enum rnea_backend backend, const char *what, FILE *f)
{
	fprintf(f, "$%s_%s << EOD\n", study_backend_name(backend), what);
	for (size_t i = 0; i < count; i++)
		if (points[i].row->backend == backend)
			fprintf(f, "%.9g %.9g\n", pow(10, points[i].x), pow(10, points[i].y));
	fprintf(f, "EOD\n");
}

static void put_frame(const struct plot *p, FILE *f)
{
	fprintf(f, "set terminal svg size %d,%d font 'sans-serif,13' background rgb 'white'\n", WIDTH, HEIGHT);
	fprintf(f, "set title '");
	put_name(f, p->report->study->analysis.robot.name);
	fprintf(f, ": inverse dynamics, speed against error' noenhanced font ',17'\n");
	fprintf(f, "set logscale xy\nset format x '10^{%%T}'\nset format y '10^{%%T}'\nset grid lc rgb '#e0e0e0'\n");
	fprintf(f, "set key below maxcolumns 2 spacing 1.2 noenhanced\nset bmargin 6\n");
	fprintf(f, "set xlabel 'largest error of %zu samples, |tau - ref| / |ref|'\n", p->report->study->options->sample.count);
	fprintf(f, "set ylabel 'samples per second, in batches of %zu'\n", p->batch);
	fprintf(f, "set xrange [%.9g:%.9g]\nset yrange [%.9g:%.9g]\n", pow(10, p->x[0]), pow(10, p->x[1]), pow(10, p->y[0]),
		pow(10, p->y[1]));
	fprintf(f, "set label 'better' at graph 0.065,0.945 font ',15' textcolor rgb '#2a7a2a'\n"
		   "set arrow from graph 0.06,0.93 to graph 0.02,0.98 lw 2 lc rgb '#2a7a2a'\n");
}

static void put_curves(const struct plot *p, FILE *f)
{
	static const char *const colours[] = {"#1f5fbf", "#d9601a"};
	const struct study *s = p->report->study;

	fprintf(f, "plot");
	for (int i = 0; i < s->backend_count; i++) {
		const char *name = study_backend_name(s->backends[i].backend), *colour = colours[i % 2];

		fprintf(f, "%s $%s_all using 1:2 with points pt 6 ps 0.7 lc rgb '%s' title '%s, ", i ? "," : "", name, colour, name);
		put_name(f, s->backends[i].device);
		fprintf(f, "', $%s_front using 1:2 smooth unique with linespoints pt 7 ps 1.1 lw 2 lc rgb '%s' title '%s: nothing "
			   "is both faster and closer'", name, colour, name);
	}
	fputc('\n', f);
}

static enum rneagen_code put_script(const struct plot *p, const char *path, const char *svg, struct rneagen_error *e)
{
	FILE *f = fopen(path, "w");

	if (!f)
		return pending_fail(path, e);
	fprintf(f, "set output '");
	for (const char *c = svg; *c; c++)
		fputs(*c == '\'' ? "''" : (char[]){*c, '\0'}, f);
	fprintf(f, "'\n");
	for (int i = 0; i < p->report->study->backend_count; i++) {
		put_data(p->points, p->count, p->report->study->backends[i].backend, "all", f);
		put_data(p->front, p->front_count, p->report->study->backends[i].backend, "front", f);
	}
	put_frame(p, f);
	for (size_t i = 0; i < p->front_count; i++)
		put_label(p, &p->front[i], f);
	put_curves(p, f);
	return fclose(f) ? pending_fail(path, e) : RNEAGEN_OK;
}

/* ---- running gnuplot ---- */

/* Found along PATH by env, without a shell; its own settings, not the user's. */
static enum rneagen_code run_gnuplot(const char *script, struct rneagen_error *e)
{
	const char *const argv[] = {"env", "gnuplot", "-d", script, NULL}, *const none[] = {NULL};
	struct child end;

	if (child_run("/usr/bin/env", argv, none, &end))
		return error_set(e, RNEAGEN_UNSUPPORTED, "--plot: /usr/bin/env cannot be run");
	if (end.status == 127)
		error_set(e, RNEAGEN_UNSUPPORTED, "--plot: gnuplot is not installed: there is none in PATH");
	else if (end.status || end.signal)
		error_set(e, RNEAGEN_UNSUPPORTED, "--plot: gnuplot fails: %.400s", end.output);
	free(end.output);
	return e->code;
}

static enum rneagen_code publish(const char *svg, const char *path, struct rneagen_error *e)
{
	struct file_content picture = {0};
	struct pending out = {0};

	if (file_read(svg, &picture, e) || pending_open(&out, path, e)) {
		free(picture.bytes);
		return e->code;
	}
	if (fwrite(picture.bytes, 1, picture.length, out.f) != picture.length)
		pending_fail(path, e);
	if (!e->code && !pending_close(&out, e))
		pending_publish(&out, e);
	pending_drop(&out);
	free(picture.bytes);
	return e->code;
}

/* In a folder of its own, which goes again. */
static enum rneagen_code draw(const struct plot *p, const char *path, struct rneagen_error *e)
{
	struct scratch s;
	char script[sizeof s.folder + 16], svg[sizeof s.folder + 16];
	int why = scratch_make(&s);

	if (why)
		return error_set(e, RNEAGEN_WRITE, "--plot: no folder can be made below TMPDIR or /tmp: %s", strerror(why));
	snprintf(script, sizeof script, "%s/plot.gp", s.folder);
	snprintf(svg, sizeof svg, "%s/plot.svg", s.folder);
	if (!put_script(p, script, svg, e) && !run_gnuplot(script, e))
		publish(svg, path, e);
	scratch_remove(&s);
	return e->code;
}

enum rneagen_code plot_write(const struct report *r, const char *path, struct rneagen_error *e)
{
	struct plot p = {.report = r};

	if (!take_points(&p))
		error_memory(e);
	else if (!p.count)
		error_set(e, RNEAGEN_UNSUPPORTED, "--plot: no variant has a finite error");
	if (!e->code) {
		take_front(&p);
		set_ranges(&p);
		place_labels(&p);
		draw(&p, path, e);
	}
	free(p.points);
	free(p.front);
	return e->code;
}
