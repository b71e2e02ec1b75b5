/* SPDX-License-Identifier: MIT
 * Names of what can be wrong with an input.
 */
#include "scene.h"

const char *const scene_reject_name[SCENE_REJECTS] = {
	[SCENE_REJECT_CRC] = "crc",       [SCENE_REJECT_COUNTER] = "counter",
	[SCENE_REJECT_LENGTH] = "length", [SCENE_REJECT_NOT_AVAILABLE] = "not_available",
	[SCENE_REJECT_RANGE] = "range",   [SCENE_REJECT_IMPLAUSIBLE] = "implausible",
};
