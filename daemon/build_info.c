/* SPDX-License-Identifier: MIT
 * What this binary was made from. See build_info.h. The only file that changes with every commit.
 */
#include "build_info.h"

#include "build.h"
#include "contract.h"
#include "version.h"

void build_info_print(const char *name, FILE *out)
{
	fprintf(out,
		"%s " AEBMC_VERSION "\ncommit   " BUILD_COMMIT "\ncompiler " BUILD_COMPILER
		"\ncuda     " BUILD_CUDA "\ncontract %04x\n",
		name, contract_hash());
}
