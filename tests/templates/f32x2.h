#ifndef TESTS_F32X2_H
#define TESTS_F32X2_H
/* The functions of templates/arithmetic/f32x2.in and sincos_f32x2_*.in, as one compiler setting makes them; a[0] + a[1] is a
   number. */

struct f32x2 {
	const char *name;
	double mul_bound, mul_f_bound; /* in u^2 = 2^-48 of the result */
	void (*add)(const float *a, const float *b, float *out);
	void (*mul)(const float *a, const float *b, float *out);
	void (*fma)(const float *a, const float *b, const float *c, float *out);
	void (*add_f)(const float *a, float b, float *out);
	void (*mul_f)(const float *a, float b, float *out);
	void (*sincos)(double x, float *s, float *c);	/* for any finite x */
	void (*bounded)(double x, float *s, float *c); /* up to 1e4 */
	void (*split)(double x, float *out);
	double (*join)(const float *a);
};

/* Without a fused multiply-add; with fmaf, by the C library where the machine has none; and with the machine's own,
   where the compiler may join products to sums (NULL where it has none). */
extern const struct f32x2 f32x2_plain, f32x2_fma;
const struct f32x2 *f32x2_contracted(void);

#endif
