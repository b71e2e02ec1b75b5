/* SPDX-License-Identifier: MIT
 * Without libsocketcan nothing is known of the controllers. See link.h.
 */
#include "link.h"

void link_read(const char *name, struct link_state *l)
{
	(void)name;
	*l = (struct link_state){.state = "unknown"};
}
