#define _POSIX_C_SOURCE 200809L
#include "target/target.h"
#include "support/read.h"
#include "emit/emit.h"
#include "support/process.h"
#include <check.h>
#include <dlfcn.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

const char *compiler_lacks(const struct compiler *c, int fma)
{
	int has_fma = 0;

#if defined __x86_64__
	has_fma = __builtin_cpu_supports("fma") && __builtin_cpu_supports("avx2");
#endif
	if (!process_exists(c->command))
		return "there is no such compiler";
	return fma && !has_fma ? "no fused multiply-add in this processor" : NULL;
}

int compiler_serves(const struct compiler *c, int fma)
{
	const char *why = compiler_lacks(c, fma);

	if (why)
		printf("skipped: %s%s%s: %s\n", c->command, c->flags[0] ? " " : "", c->flags[0] ? c->flags[0] : "", why);
	return !why;
}

const char *target_nvcc(void)
{
	const char *const places[] = {getenv("NVCC"), "nvcc", "/usr/local/cuda/bin/nvcc"};

	for (size_t i = 0; i < sizeof places / sizeof *places; i++)
		if (places[i] && process_exists(places[i]))
			return places[i];
	printf("skipped: no nvcc\n");
	return NULL;
}

struct target_path target_path(const char *name, const char *suffix)
{
	const char *part = getenv("CK_RUN_CASE"); /* cases that run at the same time have names in common */
	struct target_path path;

	ck_assert(!mkdir(BUILD_DIR "/targets", 0777) || errno == EEXIST);
	snprintf(path.s, sizeof path.s, BUILD_DIR "/targets/%s", part ? part : "");
	ck_assert(!mkdir(path.s, 0777) || errno == EEXIST);
	snprintf(path.s, sizeof path.s, BUILD_DIR "/targets/%s%s%s%s", part ? part : "", part ? "/" : "", name, suffix);
	return path;
}

void target_write(struct target_path path, const char *text)
{
	FILE *f = fopen(path.s, "wb");

	ck_assert_msg(f != NULL, "%s: %s", path.s, strerror(errno));
	ck_assert_int_ge(fputs(text, f), 0);
	ck_assert_int_eq(fclose(f), 0);
}

static char *chain(int n, size_t *length)
{
	char *urdf;
	FILE *f = open_memstream(&urdf, length);

	fputs("<robot name='chain'><link name='l0'/>", f);
	for (int i = 1; i <= n; i++)
		fprintf(f,
			"<link name='l%d'><inertial><mass value='%d.5'/><inertia ixx='0' ixy='0' ixz='0' iyy='0' iyz='0' izz='0'/></inertial></link>"
			"<joint name='j%03d' type='prismatic'><parent link='l%d'/><child link='l%d'/><axis xyz='%d %d %d'/>"
			"<limit effort='1' velocity='1' lower='-1' upper='1'/></joint>",
			i, 1 + i % 5, i, i - 1, i, i % 3 == 0, i % 3 == 1, i % 3 == 2);
	fputs("</robot>", f);
	fclose(f);
	return urdf;
}

char *target_robot(const char *name, size_t *length)
{
	char path[512], *urdf;

	if (strncmp(name, "chain ", 6) == 0)
		return chain(atoi(name + 6), length);

	snprintf(path, sizeof path, TEST_DIR "/robots/%s.urdf", name);
	urdf = read_file(path, length);
	ck_assert_msg(urdf != NULL, "%s cannot be read", path);
	return urdf;
}

void target_generate(
	struct target *t, const char *urdf, size_t length, const struct rneagen_options *o, const char *what)
{
	struct rneagen_error e;

	t->options = *o;
	if (o->trig == RNEAGEN_TRIG_AUTO)
		t->options.trig = RNEAGEN_ACCURATE;
	t->f32 = o->precision == RNEAGEN_F32 || o->precision == RNEAGEN_MIXED;
	t->f32_inside = o->precision == RNEAGEN_F32;
	t->library = NULL;
	*t->stem = '\0';
	snprintf(t->what, sizeof t->what, "%.160s %s %s %s %s%s", what, emit_precision_name(o->precision),
		o->layout == RNEAGEN_SOA ? "soa" : "aos", emit_trig_name(t->options.trig),
		o->base == RNEAGEN_FLOATING ? "floating" : "fixed", o->strict ? " strict" : "");
	ck_assert_msg(!rneagen_generate(urdf, length, o, &t->text, &e), "%s: %s", t->what, e.message);
}

void target_compile(const struct target *t, const char *const *argv)
{
	struct process p = process_run(argv);
	char line[1024] = "";

	for (int i = 0; argv[i]; i++) {
		strncat(line, argv[i], sizeof line - strlen(line) - 1);
		strncat(line, " ", sizeof line - strlen(line) - 1);
	}
	ck_assert_msg(
		p.status == 0 && !*p.output, "%s: %sgives %d and says\n%.3000s", t->what, line, p.status, p.output);
	process_free(&p);
}

static int has_angles(const struct target *t)
{
	return strstr(t->text.source, "sincos_") || strstr(t->text.source, "sincosf_");
}

/* The text as it is, and beside it a way to its own sine and cosine, which nobody else can see. */
static void write_sources(const struct target *t, const char *stem)
{
	const char *type = t->f32_inside ? "float" : "double";
	char text[1024];
	int n = snprintf(text, sizeof text, "#include \"%s.c\"\n", stem);

	if (has_angles(t) && t->options.precision == RNEAGEN_F32X2)
		snprintf(text + n, sizeof text - (size_t)n,
			"void test_sincos(double x, double *s, double *c);\n"
			"void test_sincos(double x, double *s, double *c)\n{\n\tstruct rneagen_f32x2 y, z;\n"
			"\trneagen_sincos_f32x2_%s(x, &y, &z);\n\t*s = rneagen_join(y);\n\t*c = rneagen_join(z);\n}\n",
			emit_trig_name(emit_trig_of(&t->options)));
	else if (has_angles(t))
		snprintf(text + n, sizeof text - (size_t)n,
			"void test_sincos(%s x, %s *s, %s *c);\n"
			"void test_sincos(%s x, %s *s, %s *c)\n{\n\trneagen_%ssincos%s_%s(x, s, c);\n}\n",
			type, type, type, type, type, type, t->options.strict ? "strict_" : "", t->f32_inside ? "f" : "",
			emit_trig_name(emit_trig_of(&t->options)));
	target_write(target_path(stem, ".c"), t->text.source);
	target_write(target_path(stem, ".h"), t->text.header);
	target_write(target_path(stem, "_with_sincos.c"), text);
}

void target_symbol(const struct target *t, void *library, const char *name, void *function)
{
	void *address = dlsym(library, name);

	ck_assert_msg(address != NULL, "%s: %s", t->what, dlerror());
	memcpy(function, &address, sizeof address);
}

static void find_functions(struct target *t)
{
	static const char *const suffixes[] = {"_rnea", "_rnea_batch", "_fpass", "_bpass"};
	void *const slots[2][4] = {{&t->wide.rnea, &t->wide.batch, &t->wide.fpass, &t->wide.bpass},
		{&t->single.rnea, &t->single.batch, &t->single.fpass, &t->single.bpass}};
	char name[512];

	for (int i = 0; i < 4; i++) {
		snprintf(name, sizeof name, "%s%s", t->text.name, suffixes[i]);
		target_symbol(t, t->library, name, slots[t->f32][i]);
	}
	if (has_angles(t))
		target_symbol(
			t, t->library, "test_sincos", t->f32_inside ? (void *)&t->sincos_single : (void *)&t->sincos_wide);
}

void target_open(struct target *t, const char *urdf, size_t length, const struct rneagen_options *o,
	const struct compiler *c, const char *stem)
{
	struct target_path library = target_path(stem, ".so"), source = target_path(stem, "_with_sincos.c");
	const char *argv[24] = {c->command, "-std=c11", WARNING_FLAGS, "-DRNEA_NO_LANES", "-fPIC", "-shared", "-o", library.s, source.s};
	int n = 13;

	target_generate(t, urdf, length, o, stem);
	snprintf(t->stem, sizeof t->stem, "%s", stem);
	write_sources(t, stem);
	snprintf(t->what + strlen(t->what), sizeof t->what - strlen(t->what), " %s", c->command);
	for (int i = 0; c->flags[i]; i++) {
		argv[n++] = c->flags[i];
		snprintf(t->what + strlen(t->what), sizeof t->what - strlen(t->what), " %s", c->flags[i]);
	}
	argv[n] = "-lm";
	target_compile(t, argv);
	t->library = dlopen(library.s, RTLD_NOW | RTLD_LOCAL);
	ck_assert_msg(t->library != NULL, "%s: %s", t->what, dlerror());
	find_functions(t);
	unlink(library.s);
}

void target_close(struct target *t)
{
	static const char *const suffixes[] = {".c", ".h", "_with_sincos.c"};

	if (t->library)
		dlclose(t->library);
	for (size_t i = 0; i < sizeof suffixes / sizeof *suffixes && *t->stem; i++)
		unlink(target_path(t->stem, suffixes[i]).s);
	rneagen_result_free(&t->text);
}

void target_rnea(const struct target *t, const struct array *q, const struct array *qd, const struct array *qdd,
	const struct array *tau)
{
	if (t->f32)
		t->single.rnea(q->data, qd->data, qdd->data, tau->data);
	else
		t->wide.rnea(q->data, qd->data, qdd->data, tau->data);
}

void target_batch(const struct target *t, const struct array *q, const struct array *qd, const struct array *qdd,
	const struct array *tau, size_t count)
{
	if (t->f32)
		t->single.batch(q->data, qd->data, qdd->data, tau->data, count);
	else
		t->wide.batch(q->data, qd->data, qdd->data, tau->data, count);
}

void target_fpass(const struct target *t, const struct array *q, const struct array *qd, const struct array *qdd,
	const struct array out[3])
{
	if (t->f32)
		t->single.fpass(q->data, qd->data, qdd->data, out[0].data, out[1].data, out[2].data);
	else
		t->wide.fpass(q->data, qd->data, qdd->data, out[0].data, out[1].data, out[2].data);
}

void target_bpass(const struct target *t, const struct array *q, const struct array *f, const struct array *tau)
{
	if (t->f32)
		t->single.bpass(q->data, f->data, tau->data);
	else
		t->wide.bpass(q->data, f->data, tau->data);
}

void target_sincos(const struct target *t, double x, double *s, double *c)
{
	float s32, c32;

	if (!t->f32_inside) {
		t->sincos_wide(x, s, c);
		return;
	}
	t->sincos_single((float)x, &s32, &c32);
	*s = (double)s32;
	*c = (double)c32;
}
