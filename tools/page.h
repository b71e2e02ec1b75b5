/* SPDX-License-Identifier: MIT
 * An HTML page that needs nothing else, for light and dark, with text, tables and the pictures of svg.h.
 */
#ifndef AEBMC_PAGE_H
#define AEBMC_PAGE_H

#include <stdio.h>

/**
 * page_open - begin a page, up to and with its heading @title
 * Cells are figures, on the right, but for the first of each row and those of class text. Further classes: bad and good,
 * faint, rows sum and part (of the row above), and wide around a table that may not fit. Write errors stay in
 * ferror(@out).
 */
void page_open(FILE *out, const char *title);

/** page_close - end it; @out stays open. */
void page_close(FILE *out);

#endif
