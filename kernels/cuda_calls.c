/* SPDX-License-Identifier: MIT
 * CUDA errors as -errno: one row per error that leads to a reason of its own.
 */
#include "cuda_calls.h"
#include <errno.h>
#include <stddef.h>

static const struct {
	cudaError_t cuda;
	int err;
} table[] = {
	{cudaSuccess, 0},
	{cudaErrorNotReady, -EAGAIN},
	/* no driver, or one that is older than the runtime */
	{cudaErrorInsufficientDriver, -ENOSYS},
	{cudaErrorStubLibrary, -ENOSYS},
	{cudaErrorSystemDriverMismatch, -ENOSYS},
	{cudaErrorCompatNotSupportedOnDevice, -ENOSYS},
	/* no device */
	{cudaErrorNoDevice, -ENODEV},
	{cudaErrorInvalidDevice, -ENODEV},
	{cudaErrorDevicesUnavailable, -ENODEV},
	/* a device that this binary has no machine code for */
	{cudaErrorNoKernelImageForDevice, -ENOEXEC},
	{cudaErrorInvalidDeviceFunction, -ENOEXEC},
	{cudaErrorInvalidKernelImage, -ENOEXEC},
	{cudaErrorUnsupportedPtxVersion, -ENOEXEC},
	{cudaErrorMemoryAllocation, -ENOMEM},
	{cudaErrorIllegalAddress, -EFAULT},
	{cudaErrorMisalignedAddress, -EFAULT},
	{cudaErrorInvalidAddressSpace, -EFAULT},
	{cudaErrorLaunchTimeout, -ETIMEDOUT},
	{cudaErrorECCUncorrectable, -EBADMSG},
};

int cuda_calls_errno(cudaError_t err)
{
	for (size_t i = 0; i < sizeof(table) / sizeof(table[0]); i++) {
		if (table[i].cuda == err) {
			return table[i].err;
		}
	}
	return -EIO;
}
