/* SPDX-License-Identifier: MIT
 * The entry points of the subcommands, one per row of cmd.def.
 */
#ifndef AEBMC_CMD_H
#define AEBMC_CMD_H

#define CMD(name, help) int cmd_##name(int argc, char **argv);
#include "cmd.def"
#undef CMD

#endif
