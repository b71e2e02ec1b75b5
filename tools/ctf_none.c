/* SPDX-License-Identifier: MIT
 * Without libbabeltrace2: no trace can be read. See ctf.h.
 */
#include "ctf.h"
#include <errno.h>
#include <stdio.h>

int ctf_read(const char *dir, ctf_event *event, void *arg, struct ctf_lost *lost, char *err,
	     int err_len)
{
	(void)event;
	(void)arg;
	(void)lost;
	snprintf(err, (size_t)err_len,
		 "%s: this program was built without libbabeltrace2 (libbabeltrace2-dev)", dir);
	return -ENOTSUP;
}
