/* SPDX-License-Identifier: MIT
 * The release, in one place.
 */
#ifndef AEBMC_VERSION_H
#define AEBMC_VERSION_H

#define AEBMC_VERSION "0.1.0"

#endif
