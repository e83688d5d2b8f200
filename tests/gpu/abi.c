/* The runtime declares what it uses of CUDA by itself; where cuda.h and nvrtc.h are at hand, the two are compared. */
#include "../../runtime/device.h"
#include "../../runtime/nvrtc.h"
#include <cuda.h>
#include <nvrtc.h>

#define SAME(ours, theirs) _Static_assert((int)(ours) == (int)(theirs), #theirs)

SAME(DEVICE_STATUS_MEMORY, CUDA_ERROR_OUT_OF_MEMORY);
SAME(DEVICE_STATUS_STUB, CUDA_ERROR_STUB_LIBRARY);
SAME(DEVICE_STATUS_NO_DEVICE, CUDA_ERROR_NO_DEVICE);
SAME(DEVICE_STATUS_BAD_DEVICE, CUDA_ERROR_INVALID_DEVICE);
SAME(DEVICE_STATUS_NOT_FOUND, CUDA_ERROR_NOT_FOUND);
SAME(DEVICE_ATTRIBUTE_MAJOR, CU_DEVICE_ATTRIBUTE_COMPUTE_CAPABILITY_MAJOR);
SAME(DEVICE_ATTRIBUTE_MINOR, CU_DEVICE_ATTRIBUTE_COMPUTE_CAPABILITY_MINOR);
SAME(DEVICE_JIT_ERROR_LOG, CU_JIT_ERROR_LOG_BUFFER);
SAME(DEVICE_JIT_ERROR_LOG_SIZE, CU_JIT_ERROR_LOG_BUFFER_SIZE_BYTES);
SAME(DEVICE_STREAM_NON_BLOCKING, CU_STREAM_NON_BLOCKING);
SAME(DEVICE_FUNC_MAX_THREADS, CU_FUNC_ATTRIBUTE_MAX_THREADS_PER_BLOCK);
SAME(DEVICE_FUNC_SHARED_BYTES, CU_FUNC_ATTRIBUTE_SHARED_SIZE_BYTES);
SAME(DEVICE_FUNC_LOCAL_BYTES, CU_FUNC_ATTRIBUTE_LOCAL_SIZE_BYTES);
SAME(DEVICE_FUNC_REGISTERS, CU_FUNC_ATTRIBUTE_NUM_REGS);
SAME(NVRTC_STATUS_MEMORY, NVRTC_ERROR_OUT_OF_MEMORY);
SAME(NVRTC_STATUS_COMPILATION, NVRTC_ERROR_COMPILATION);
SAME(sizeof(CUdevice), sizeof(int));
SAME(sizeof(CUdeviceptr), sizeof(unsigned long long));
SAME(sizeof(CUresult), sizeof(int));
SAME(sizeof(CUjit_option), sizeof(int));
SAME(sizeof(nvrtcResult), sizeof(int));

/* Symbols that carry a version: what cuda.h calls by that name is what the runtime looks up. */
#define KNOWN(name) _Static_assert(sizeof(&name) == sizeof(void (*)(void)), #name)

KNOWN(cuInit);
KNOWN(cuDevicePrimaryCtxRelease_v2);
KNOWN(cuCtxPushCurrent_v2);
KNOWN(cuCtxPopCurrent_v2);
KNOWN(cuModuleGetGlobal_v2);
KNOWN(cuMemcpyDtoH_v2);
KNOWN(cuStreamDestroy_v2);
