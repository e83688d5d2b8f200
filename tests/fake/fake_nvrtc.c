/* An NVRTC for machines without one, chosen by RNEA_NVRTC: builds CUDA C for the processor with the C++ compiler, as a
   shared object that the driver in fake_cuda.c runs. FAKE_CXX, FAKE_HEADER: the compiler, and fake_device.h.

   What was built once is kept in FAKE_CACHE, by the text, the command and fake_device.h, for tests of the same text.

   A program of kernels of large batches alone is refused, unless RNEA_FAKE_PARTS is set: few tests have such batches.

   Environment: RNEA_FAKE_NVRTC_FAIL=CODE makes nvrtcCompileProgram return CODE; RNEA_FAKE_ARCHS="75 80" are the
   architectures it claims to know (default "75 80 90"). */
#define _GNU_SOURCE
#include "fake_cache.h"
#include <ctype.h>
#include <elf.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

struct program {
	char *source, *name, *log, *image;
	size_t image_size;
	int is_ptx;
};

enum { SUCCESS, INVALID_PROGRAM = 4, INVALID_OPTION = 5, COMPILATION = 6, OPTION_LIMIT = 32, COMMAND_LIMIT = 8192,
	OWN_SHARED_LIMIT = 48 << 10 };

static atomic_int compilations;

/* For the tests: how often nvrtcCompileProgram was called. */
int fake_nvrtc_compilations(void)
{
	return compilations;
}

static int archs(int *list)
{
	const char *s = getenv("RNEA_FAKE_ARCHS");
	int count = 0, used;

	for (s = s ? s : "75 80 90"; sscanf(s, "%d%n", &list[count], &used) == 1; s += used)
		count++;
	return count;
}

int nvrtcVersion(int *major, int *minor)
{
	*major = 0;
	*minor = 1;
	return SUCCESS;
}

const char *nvrtcGetErrorString(int status)
{
	return status == COMPILATION ? "NVRTC_ERROR_COMPILATION" : status ? "NVRTC_ERROR_FAKE" : "NVRTC_SUCCESS";
}

int nvrtcGetNumSupportedArchs(int *count)
{
	int list[OPTION_LIMIT];

	*count = archs(list);
	return SUCCESS;
}

int nvrtcGetSupportedArchs(int *list)
{
	archs(list);
	return SUCCESS;
}

int nvrtcCreateProgram(void **program, const char *source, const char *name, int header_count,
	const char *const *headers, const char *const *include_names)
{
	struct program *p = calloc(1, sizeof *p);

	(void)headers;
	(void)include_names;
	if (!p || header_count)
		return INVALID_PROGRAM;
	p->source = strdup(source);
	p->name = strdup(name);
	*program = p;
	return SUCCESS;
}

int nvrtcDestroyProgram(void **program)
{
	struct program *p = *program;

	free(p->source);
	free(p->name);
	free(p->log);
	free(p->image);
	free(p);
	*program = NULL;
	return SUCCESS;
}

/* The identifier before the parenthesis that opens the parameters of the __global__ function at `s`. */
static const char *kernel_name(const char *s, size_t *length)
{
	for (;;) {
		s += strcspn(s, "(_abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ");
		*length = 0;
		while (isalnum((unsigned char)s[*length]) || s[*length] == '_')
			++*length;
		if (*s == '(')
			s = strchr(s, ')') + 1; /* of __launch_bounds__ */
		else if (s[*length] == '(' && strncmp(s, "__launch_bounds__", *length) != 0)
			return s;
		else
			s += *length;
	}
}

/* The text; `extern __shared__` names memory of the launch, not of the kernel. */
static void write_text(FILE *f, const char *text)
{
	static const char given[] = "extern __shared__";
	const char *s;

	for (; (s = strstr(text, given)) != NULL; text = s + strlen(given))
		fprintf(f, "%.*sextern", (int)(s - text), text);
	fprintf(f, "%s\n", text);
}

/* Where the kernel of small batches begins, or the text ends. */
static const char *limbs_of(const char *text)
{
	const char *s = strstr(text, "#if !defined RNEA_NO_LIMBS\n/*");

	return s ? s : text + strlen(text);
}

/* Where kernels of parts, which stand before all others, begin and end; the text's begin where it has none. */
static const char *alone_begin(const char *text)
{
	const char *s = strstr(text, "#define RNEA_PART_KERNELS ");

	return s ? s : text;
}

static const char *alone_end(const char *text)
{
	const char *s = alone_begin(text);

	s = s > text ? strstr(s, "#if !defined RNEA_ONLY_PART_KERNELS\n") : NULL;
	return s ? s : text;
}

/* That kernel's memory of the launch is under a name of its own. */
static void write_given(FILE *f, const struct program *p)
{
	static const char mark[] = "_across[];";
	const char *end = strstr(limbs_of(p->source), mark), *name = end;

	fputs(end ? "#if RNEA_GIVEN_BYTES || defined RNEA_LIMBS || defined RNEA_SOLVE || defined RNEA_TRANSPOSED\n"
		  : "#if RNEA_GIVEN_BYTES || defined RNEA_SOLVE || defined RNEA_TRANSPOSED\n",
		f);
	fputs("alignas(1024) unsigned char fake_given_memory[FAKE_MOST_SHARED];\n#endif\n", f);
	while (name && name[-1] != ' ')
		name--;
	if (end)
		fprintf(f,
			"#if defined RNEA_LIMBS\nextern \"C\" __attribute__((alias(\"slices\"))) unsigned char "
			"fake_across[FAKE_MOST_SHARED] __asm__(\"%.*s_across\");\n#endif\n",
			(int)(end - name), name);
}

/* Where threads wait for each other; NULL: nowhere. */
static const char *wait_of(const char *text)
{
	const char *block = strstr(text, "__syncthreads()"), *warp = strstr(text, "__syncwarp()");

	return !block || (warp && warp < block) ? warp : block;
}

static void write_source(const struct program *p, const char *path)
{
	static const char mark[] = "extern \"C\" __global__ void"; /* a joint may be called __global__ */
	const char *s = p->source, *limbs = limbs_of(s), *wait = wait_of(s), *alone = alone_begin(s), *rest = wait_of(alone_end(s));
	int alone_waits = wait_of(alone) && wait_of(alone) < alone_end(s), limbs_wait = wait_of(limbs) != NULL;
	int waits = (wait && wait < alone) || (rest && rest < limbs);
	FILE *f = fopen(path, "w");
	size_t length;

	fprintf(f, "#define FAKE_WAITS %d\n#include \"%s\"\n#line 1 \"%s\"\n", wait != NULL, FAKE_HEADER, p->name);
	write_text(f, p->source);
	write_given(f, p);
	fputs("#if defined RNEA_MIN_BLOCKS\n#define FAKE_MIN_BLOCKS RNEA_MIN_BLOCKS\n#else\n#define FAKE_MIN_BLOCKS 0\n#endif\n",
		f);
	while ((s = strstr(s, mark)) != NULL) {
		int is_limbs = s > limbs, is_alone = s < alone_end(p->source);

		s = kernel_name(s + strlen(mark), &length);
		fprintf(f, "#if !defined %s%s\nFAKE_KERNEL(%.*s, %s)\n#endif\n", is_limbs ? "RNEA_NO_LIMBS" : "RNEA_ONLY_LIMBS",
			is_limbs ? "" : is_alone ? " && !defined RNEA_NO_PART_KERNELS" : " && !defined RNEA_ONLY_PART_KERNELS",
			(int)length, s, (is_limbs ? limbs_wait : is_alone ? alone_waits : waits) ? "fake_run_threads" : "fake_run_serial");
	}
	fclose(f);
}

static char *read_file(const char *path, size_t *size)
{
	FILE *f = fopen(path, "rb");
	long length = f && !fseek(f, 0, SEEK_END) ? ftell(f) : 0;
	char *bytes = calloc(1, (size_t)(length > 0 ? length : 0) + 1);

	*size = f && bytes && !fseek(f, 0, SEEK_SET) ? fread(bytes, 1, (size_t)length, f) : 0;
	if (f)
		fclose(f);
	return bytes;
}

/* Only -D goes on to the compiler; 0 for an option that is not known. */
static int take_option(struct program *p, const char *option, char *command)
{
	size_t used = strlen(command);

	if (strncmp(option, "-D", 2) == 0)
		snprintf(command + used, COMMAND_LIMIT - used, " '%s'", option);
	else if (strncmp(option, "--gpu-architecture=", 19) == 0) {
		p->is_ptx = option[19] == 'c';
		if (strchr(option, '_') && atoi(strchr(option, '_') + 1) < 90) /* no engine that moves tiles */
			snprintf(command + used, COMMAND_LIMIT - used, " -DRNEA_TILES=0");
	}
	else if (strcmp(option, "--no-cache") == 0)
		return 1;
	else
		return 0;
	return 1;
}

/* Bytes of shared memory that a kernel has of its own: each array is a section of the image, which is a shared object, and a
   kernel has one that counts. */
static size_t own_shared(const char *image)
{
	const Elf64_Ehdr *head = (const void *)image;
	const Elf64_Shdr *sections = (const void *)(image + head->e_shoff);
	const char *names = image + sections[head->e_shstrndx].sh_offset;
	size_t most = 0;

	for (int i = 0; i < head->e_shnum; i++)
		if (strncmp(names + sections[i].sh_name, "fake_shared", strlen("fake_shared")) == 0 && sections[i].sh_size > most)
			most = sections[i].sh_size;
	return most;
}

/* As ptxas does, refuse a kernel with more than every device has. */
static int check_shared(struct program *p)
{
	size_t bytes = own_shared(p->image);

	if (bytes <= OWN_SHARED_LIMIT)
		return SUCCESS;
	free(p->log);
	p->log = calloc(1, 256);
	snprintf(p->log, 256, "ptxas error   : Entry function uses too much shared data (0x%zx bytes, 0x%x max)\n", bytes,
		OWN_SHARED_LIMIT);
	return COMPILATION;
}

/* Into the file, which is of the folder alone. */
static int run_compiler(struct program *p, const char *folder, char *command, const char *path)
{
	char result[128];
	size_t size, used = strlen(command);
	int status;

	snprintf(command + used, COMMAND_LIMIT - used, " -o %s/text.so %s 2>%s/log", folder, path, folder);
	status = system(command);
	command[used] = '\0';
	snprintf(result, sizeof result, "%s/log", folder);
	free(p->log);
	p->log = read_file(result, &size);
	unlink(result);
	snprintf(result, sizeof result, "%s/text.so", folder);
	p->image = read_file(result, &p->image_size);
	unlink(result);
	return status;
}

static int build(struct program *p, const char *folder, char *command)
{
	struct fake_cache cache;
	char path[128];
	int status = 0;

	snprintf(path, sizeof path, "%s/text.cc", folder);
	write_source(p, path);
	cache = fake_cache_open(command, path, FAKE_HEADER);
	p->image = fake_cache_read(&cache, &p->image_size);
	if (!p->image) {
		status = run_compiler(p, folder, command, path);
		if (!status)
			fake_cache_write(&cache, p->image, p->image_size);
	}
	fake_cache_close(&cache);
	unlink(path);
	return status ? COMPILATION : check_shared(p);
}

static int refuses(int count, const char *const *options)
{
	int is_alone = 0;

	for (int i = 0; i < count; i++)
		is_alone |= strcmp(options[i], "-DRNEA_ONLY_PART_KERNELS") == 0;
	return is_alone && !getenv("RNEA_FAKE_PARTS");
}

int nvrtcCompileProgram(void *program, int count, const char *const *options)
{
	/* what lies where a device cannot read or write it ends the program, as it does there; optimised, texts are compiled for longer
	   than they run; products are joined to sums where the text says so alone */
	static const char flags[] = FAKE_CXX " " FAKE_CXX_FLAG " -std=c++17 -O0 -ffp-contract=off -shared -fPIC -w -pthread"
						 " -fsanitize=alignment -fsanitize-undefined-trap-on-error";
	const char *fail = getenv("RNEA_FAKE_NVRTC_FAIL");
	char folder[] = "/tmp/fake_nvrtc_XXXXXX", command[COMMAND_LIMIT];
	struct program *p = program;
	int status;

	if (refuses(count, options))
		return COMPILATION;
	compilations++;
	strcpy(command, flags);
	if (fail)
		return atoi(fail);
	for (int i = 0; i < count; i++)
		if (!take_option(p, options[i], command)) {
			p->log = calloc(1, 256);
			snprintf(p->log, 256, "nvrtc: error: unrecognized option %s found\n", options[i]);
			return INVALID_OPTION;
		}
	if (!mkdtemp(folder))
		return INVALID_PROGRAM;
	status = build(p, folder, command);
	rmdir(folder);
	return status;
}

int nvrtcGetProgramLogSize(void *program, size_t *size)
{
	const struct program *p = program;

	*size = p->log ? strlen(p->log) + 1 : 1;
	return SUCCESS;
}

int nvrtcGetProgramLog(void *program, char *log)
{
	const struct program *p = program;

	strcpy(log, p->log ? p->log : "");
	return SUCCESS;
}

static int image_size(const struct program *p, int is_ptx, size_t *size)
{
	*size = p->image_size;
	return p->image && p->is_ptx == is_ptx ? SUCCESS : INVALID_PROGRAM;
}

int nvrtcGetCUBINSize(void *program, size_t *size)
{
	return image_size(program, 0, size);
}

int nvrtcGetPTXSize(void *program, size_t *size)
{
	return image_size(program, 1, size);
}

int nvrtcGetCUBIN(void *program, char *image)
{
	const struct program *p = program;

	memcpy(image, p->image, p->image_size);
	return SUCCESS;
}

int nvrtcGetPTX(void *program, char *image)
{
	return nvrtcGetCUBIN(program, image);
}
