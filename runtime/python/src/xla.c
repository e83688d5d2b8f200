/* XLA's calls, for JAX: handlers that run a kept text on XLA's buffers, on the processor or in a GPU's stream. Written
   to version 0.1 of XLA's foreign function interface, in plain C: what later headers add is not touched, so the header
   may be any from 0.1 on. */
#include "module.h"
#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>

#ifdef RNEAGEN_XLA

#include <xla/ffi/api/c_api.h>

#if XLA_FFI_API_MAJOR != 0
#error "the handlers are written to version 0 of XLA's interface: look at xla.c"
#endif

/* What XLA compares with its own: one that is newer than XLA's would be refused. */
enum { MINOR = 1 };

/* A text that XLA's programs may name. Their attribute is a number, not an address: programs are kept in caches and files. */
struct kept {
	int64_t number;
	int device; /* -1: the processor */
	const struct rnea_robot *robot;
	struct kept *next;
};

/* XLA hands a handler nothing of its own, and may call it as long as the process lives: so what was kept is found here,
   and stays. */
static struct kept *_Atomic first_kept;

static const struct rnea_robot *find(int64_t number, int device)
{
	for (const struct kept *k = atomic_load(&first_kept); k; k = k->next)
		if (k->number == number && k->device == device)
			return k->robot;
	return NULL;
}

static XLA_FFI_Error *fail(const XLA_FFI_CallFrame *f, XLA_FFI_Error_Code code, const char *message)
{
	XLA_FFI_Error_Create_Args args = {XLA_FFI_Error_Create_Args_STRUCT_SIZE, NULL, message, code};

	return f->api->XLA_FFI_Error_Create(&args);
}

/* XLA asks what a handler is. */
static int tell(const XLA_FFI_CallFrame *f, XLA_FFI_Handler_Traits traits)
{
	const XLA_FFI_Extension_Base *base = f->extension_start;
	XLA_FFI_Metadata *m;

	if (!base || base->type != XLA_FFI_Extension_Metadata)
		return 0;
	m = ((const XLA_FFI_Metadata_Extension *)base)->metadata;
	m->api_version.major_version = XLA_FFI_API_MAJOR;
	m->api_version.minor_version = MINOR;
	m->traits = traits;
	return 1;
}

static int read_number(const XLA_FFI_Attrs *attrs, int64_t *number)
{
	const XLA_FFI_Scalar *scalar;

	if (attrs->size != 1 || attrs->types[0] != XLA_FFI_AttrType_SCALAR)
		return 0;
	scalar = attrs->attrs[0];
	*number = scalar->dtype == XLA_FFI_DataType_S64 ? *(const int64_t *)scalar->value : 0;
	return scalar->dtype == XLA_FFI_DataType_S64;
}

static size_t elements(const XLA_FFI_Buffer *b)
{
	size_t n = 1;

	for (int64_t i = 0; i < b->rank; i++)
		n *= (size_t)b->dims[i];
	return n;
}

/* XLA's buffers as the text's arrays. Do they fit? A program out of a file may be of other arrays than the robot now is. */
static int take_buffers(const XLA_FFI_CallFrame *f, const struct rnea_robot *robot, void **pointers, size_t *count)
{
	const struct rnea_info *info = rnea_info(robot);
	size_t inputs = info->input_count, outputs = info->output_count;
	XLA_FFI_DataType type = info->precision == RNEA_F32 ? XLA_FFI_DataType_F32 : XLA_FFI_DataType_F64;

	if ((size_t)f->args.size != inputs || (size_t)f->rets.size != outputs)
		return 0;
	*count = elements(f->rets.rets[0]) / info->arguments[inputs].rows;
	for (size_t i = 0; i < inputs + outputs; i++) {
		const XLA_FFI_Buffer *b = i < inputs ? f->args.args[i] : f->rets.rets[i - inputs];
		const struct rnea_argument *a = &info->arguments[i];

		if (b->dtype != type || elements(b) != a->rows * (a->per_batch ? 1 : *count))
			return 0;
		pointers[i] = b->data;
	}
	return 1;
}

static const struct rnea_robot *find_for(const XLA_FFI_CallFrame *f, int device)
{
	int64_t number;

	return read_number(&f->attrs, &number) ? find(number, device) : NULL;
}

static XLA_FFI_Error *run(const XLA_FFI_CallFrame *f, int device, void *stream)
{
	const struct rnea_robot *robot = find_for(f, device);
	void *pointers[RNEA_ARGUMENT_LIMIT];
	struct rnea_error e;
	enum rnea_code code;
	size_t count;

	if (!robot)
		return fail(f, XLA_FFI_Error_Code_NOT_FOUND,
			"rneagen: the program is of a robot that was not called with JAX in this process, or on "
			"this device: load the robot and trace the function anew");
	if (!take_buffers(f, robot, pointers, &count))
		return fail(f, XLA_FFI_Error_Code_INVALID_ARGUMENT, "rneagen: the program's arrays are not those of the robot");
	if (!count)
		return NULL;
	code = device < 0 ? rnea_run_aos(robot, pointers, count, &e) : rnea_launch(robot, pointers, count, stream, &e);
	return code ? fail(f, XLA_FFI_Error_Code_INTERNAL, e.message) : NULL;
}

static XLA_FFI_Error *run_cpu(XLA_FFI_CallFrame *f)
{
	return tell(f, 0) ? NULL : run(f, -1, NULL);
}

/* The number of the GPU; 0 where XLA is too old to tell. */
static XLA_FFI_Error *device_of(const XLA_FFI_CallFrame *f, int *device)
{
	XLA_FFI_DeviceOrdinal_Get_Args args = {XLA_FFI_DeviceOrdinal_Get_Args_STRUCT_SIZE, NULL, f->ctx, 0};
	size_t wanted = XLA_FFI_STRUCT_SIZE(XLA_FFI_Api, XLA_FFI_DeviceOrdinal_Get);
	XLA_FFI_Error *error = f->api->struct_size < wanted ? NULL : f->api->XLA_FFI_DeviceOrdinal_Get(&args);

	*device = args.device_ordinal;
	return error;
}

/* Enqueued on XLA's own stream: nothing waits, and XLA may capture it in a graph. */
static XLA_FFI_Error *run_cuda(XLA_FFI_CallFrame *f)
{
	XLA_FFI_Stream_Get_Args args = {XLA_FFI_Stream_Get_Args_STRUCT_SIZE, NULL, f->ctx, NULL};
	XLA_FFI_Error *error;
	int device;

	if (tell(f, XLA_FFI_HANDLER_TRAITS_COMMAND_BUFFER_COMPATIBLE))
		return NULL;
	error = device_of(f, &device);
	if (!error)
		error = f->api->XLA_FFI_Stream_Get(&args);
	return error ? error : run(f, device, args.stream);
}

PyObject *xla_handlers(PyObject *self, PyObject *unused)
{
	(void)self, (void)unused;
	return Py_BuildValue("{sNsN}", "cpu", PyCapsule_New((void *)run_cpu, NULL, NULL), "CUDA",
		PyCapsule_New((void *)run_cuda, NULL, NULL));
}

PyObject *xla_keep(PyObject *self, PyObject *args)
{
	const struct core *core = PyModule_GetState(self);
	long long number;
	PyObject *kernel;
	struct kept *k;
	int device;

	if (!PyArg_ParseTuple(args, "LO!i", &number, core->kernel, &kernel, &device))
		return NULL;
	if (find(number, device))
		return Py_NewRef(Py_None);
	k = malloc(sizeof *k);
	if (!k)
		return PyErr_NoMemory();
	Py_INCREF(kernel);
	*k = (struct kept){number, device, ((struct kernel *)kernel)->robot, atomic_load(&first_kept)};
	((struct kernel *)kernel)->is_async = 1;
	while (!atomic_compare_exchange_weak(&first_kept, &k->next, k))
		;
	return Py_NewRef(Py_None);
}

#else

PyObject *xla_handlers(PyObject *self, PyObject *unused)
{
	(void)self, (void)unused;
	return PyDict_New();
}

PyObject *xla_keep(PyObject *self, PyObject *args)
{
	(void)self, (void)args;
	PyErr_SetString(PyExc_RuntimeError, "built without XLA's header");
	return NULL;
}

#endif
