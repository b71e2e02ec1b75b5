/* SPDX-License-Identifier: MIT
 * Head and style sheet of the HTML pages. See page.h.
 */
#include "page.h"
#include "svg.h"

static const char style[] =
	":root{color-scheme:light dark;--ink:#1b1f24;--paper:#fff;--faint:#667;--line:#d8dce2;"
	"--bad:#b3261e;--good:#1a7f37}\n"
	"@media(prefers-color-scheme:dark){:root{--ink:#e6e8eb;--paper:#12161c;--faint:#9aa4ae;"
	"--line:#333a42;--bad:#ff8a80;--good:#7ee2a0}}\n"
	"body{font:15px/1.45 system-ui,sans-serif;color:var(--ink);background:var(--paper);"
	"margin:2rem auto;max-width:1100px;padding:0 1rem}\n"
	"h1{font-size:1.5rem;margin:0}h2{font-size:1.15rem;margin:2.2rem 0 .4rem}"
	"p{margin:.3rem 0}\n"
	".faint{color:var(--faint)}.bad{color:var(--bad);font-weight:600}"
	".good{color:var(--good);font-weight:600}\n"
	"table{border-collapse:collapse;width:100%;font-variant-numeric:tabular-nums}"
	".wide{overflow-x:auto}\n"
	"th,td{text-align:right;padding:.18rem .5rem;border-bottom:1px solid var(--line)}"
	"th{font-weight:600}th:first-child,td:first-child,td.text{text-align:left}\n"
	"td:first-child{white-space:nowrap}tr.sum td{font-weight:600}"
	"tr.part td{color:var(--faint)}\n"
	".fig{width:100%;display:block;margin:.6rem 0}\n";

void page_open(FILE *out, const char *title)
{
	fputs("<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport "
	      "content=\"width=device-width\"><title>",
	      out);
	svg_escape(out, title);
	fprintf(out, "</title><style>\n%s", style);
	svg_css(out);
	fputs("</style>\n<h1>", out);
	svg_escape(out, title);
	fputs("</h1>\n", out);
}

void page_close(FILE *out)
{
	fputs("</html>\n", out);
}
