/* SPDX-License-Identifier: MIT
 * Charts as SVG: the page, its style and its panels.
 */
#include "svg.h"
#include <string.h>
#include "svg_priv.h"

#define LEFT_PX    64
#define RIGHT_PX   18
#define HEAD_PX    24 /* above each plot: title and legend */
#define NUMBERS_PX 38 /* below a plot with numbers and a label */
#define NOTE_PX    16

/* Okabe and Ito's colours, darker or lighter where a thin line would not stand out. No var(): librsvg has none. */
void svg_css(FILE *out)
{
	fputs(".fig{max-width:100%;height:auto;font-family:Helvetica,Arial,sans-serif;"
	      "font-size:11.5px}\n"
	      ".fig text{fill:#24292f;stroke:none}\n"
	      ".fig .ti{font-size:15px;font-weight:bold}.fig .pt{font-weight:bold}\n"
	      ".fig .s{fill:#57606a}\n"
	      ".fig .bg{fill:#fff}.fig .g{fill:none;stroke:#e4e7eb}.fig .fr{fill:none;stroke:"
	      "#8c959f}\n"
	      ".fig .h{paint-order:stroke;stroke:#fff;stroke-width:3px;stroke-linejoin:round}\n"
	      ".fig .l{fill:none;stroke:currentColor;stroke-width:1.6;stroke-linejoin:round}\n"
	      ".fig .t{stroke-width:1.2;stroke-dasharray:5 4}\n"
	      ".fig .d{fill:none;stroke:currentColor;stroke-width:5;stroke-linecap:round}\n"
	      ".fig .b{fill:currentColor;fill-opacity:.22}.fig .f{fill:currentColor;"
	      "fill-opacity:.75}"
	      ".fig .sp{fill:currentColor;fill-opacity:.5}\n"
	      ".fig .c0{color:#0072b2}.fig .c1{color:#c8500a}.fig .c2{color:#008660}"
	      ".fig .c3{color:#a8478a}\n"
	      ".fig .c4{color:#c98500}.fig .c5{color:#3a9bd6}.fig .c6{color:#7d858e}\n"
	      "@media (prefers-color-scheme:dark){\n"
	      ".fig text{fill:#e6edf3}.fig .s{fill:#9da7b1}\n"
	      ".fig .bg{fill:#12161c}.fig .g{stroke:#2a313a}.fig .fr{stroke:#6e7681}"
	      ".fig .h{stroke:#12161c}\n"
	      ".fig .c0{color:#4aa8e8}.fig .c1{color:#ff8f4d}.fig .c2{color:#2fc295}"
	      ".fig .c3{color:#e08cc4}\n"
	      ".fig .c4{color:#f0b73a}.fig .c5{color:#8fd0f7}.fig .c6{color:#949ea8}\n"
	      "}\n",
	      out);
}

/* ---- text -------------------------------------------------------------------------------------- */

/* Bytes of the UTF-8 character at @p, 0 if it is none. */
static int utf8_length(const unsigned char *p)
{
	const int n = p[0] < 0x80 ? 1 : p[0] < 0xc2 ? 0 : p[0] < 0xe0 ? 2 : p[0] < 0xf0 ? 3 : 4;

	if (p[0] > 0xf4 || (p[0] == 0xe0 && p[1] < 0xa0) || (p[0] == 0xed && p[1] > 0x9f) ||
	    (p[0] == 0xf0 && p[1] < 0x90) || (p[0] == 0xf4 && p[1] > 0x8f)) {
		return 0;
	}
	for (int i = 1; i < n; i++) {
		if ((p[i] & 0xc0) != 0x80) {
			return 0;
		}
	}
	return n;
}

static void escape_char(FILE *out, const unsigned char *p, int n)
{
	switch (p[0]) {
	case '&':
		fputs("&amp;", out);
		return;
	case '<':
		fputs("&lt;", out);
		return;
	case '>':
		fputs("&gt;", out);
		return;
	case '"':
		fputs("&quot;", out);
		return;
	default:
		if (n == 0 || p[0] < 0x20 || p[0] == 0x7f) {
			fputc('?', out);
		} else {
			fwrite(p, 1, (size_t)n, out);
		}
	}
}

void svg_escape(FILE *out, const char *text)
{
	const unsigned char *p = (const unsigned char *)text;

	while (*p) {
		int n = utf8_length(p);

		escape_char(out, p, n);
		p += n ? n : 1;
	}
}

/* Widths as in Helvetica, in shares of the size; of characters beyond ASCII the mean. */
double svg_text_px(const char *text)
{
	double em = 0;

	for (; *text; text++) {
		const unsigned char c = (unsigned char)*text;

		em += (c & 0xc0) == 0x80              ? 0
		      : strchr("ijlt.,:;'|!I ()f", c) ? 0.29
		      : strchr("mwMW%@", c)           ? 0.84
		      : c >= 'A' && c <= 'Z'          ? 0.68
						      : 0.55;
	}
	return em * SVG_TEXT_PX;
}

void svg_text(FILE *out, const char *class, double x_px, double y_px, char anchor, const char *text)
{
	fprintf(out, "<text class=\"%s\" x=\"%.1f\" y=\"%.1f\"%s>", class, x_px, y_px,
		anchor == 'e'   ? " text-anchor=\"end\""
		: anchor == 'm' ? " text-anchor=\"middle\""
				: "");
	svg_escape(out, text);
	fputs("</text>\n", out);
}

/* ---- page -------------------------------------------------------------------------------------- */

struct svg svg_start(FILE *out, const struct svg_page *page)
{
	struct svg s = {.out = out, .page = *page, .top_px = page->subtitle ? 42 : 26};

	s.page.left_px = page->left_px > 0 ? page->left_px : LEFT_PX;
	s.page.shares = page->shares > 0 ? page->shares : 1;
	fprintf(out,
		"<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"fig\" role=\"img\" width=\"%g\" "
		"height=\"%g\" viewBox=\"0 0 %g %g\">\n<title>",
		page->width_px, page->height_px, page->width_px, page->height_px);
	svg_escape(out, page->title);
	fputs("</title>\n", out);
	if (!page->embedded) {
		fputs("<style>\n", out);
		svg_css(out);
		fputs("</style>\n", out);
	}
	fprintf(out, "<rect class=\"bg\" width=\"%g\" height=\"%g\"/>\n", page->width_px,
		page->height_px);
	svg_text(out, "ti", 12, 21, 's', page->title);
	if (page->subtitle) {
		svg_text(out, "s", 12, 38, 's', page->subtitle);
	}
	if (page->note) {
		svg_text(out, "s", page->width_px - RIGHT_PX, page->height_px - 7, 'e', page->note);
	}
	return s;
}

static void end_panel(struct svg *s)
{
	if (s->in_panel) {
		fputs("</svg>\n", s->out);
	}
	s->in_panel = 0;
}

/* What the panels share: all but the title above and the note below. */
static double usable_px(const struct svg_page *p)
{
	return p->height_px - (p->subtitle ? 42 : 26) - (p->note ? NOTE_PX : 0) - 6;
}

void svg_panel(struct svg *s, const struct svg_panel *p)
{
	const double share = p->share > 0 ? p->share : 1;
	const double all_px = share / s->page.shares * usable_px(&s->page);

	end_panel(s);
	s->x = svg_axis_sane(&p->x);
	s->y = svg_axis_sane(&p->y);
	s->x_px = s->page.left_px;
	s->y_px = s->top_px + HEAD_PX;
	s->w_px = s->page.width_px - s->page.left_px - RIGHT_PX;
	s->h_px = all_px - HEAD_PX - (p->x.label ? NUMBERS_PX : 0);
	s->top_px += all_px;
	svg_draw_axes(s);
	if (p->title) {
		svg_text(s->out, "pt", s->x_px, s->y_px - 8, 's', p->title);
	}
	svg_draw_keys(s, p->key, p->keys);
	/* A picture of its own clips its marks; 1 px more keeps lines on the frame whole. */
	fprintf(s->out,
		"<svg x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" viewBox=\"-1 -1 %.1f "
		"%.1f\" overflow=\"hidden\">\n",
		s->x_px - 1, s->y_px - 1, s->w_px + 2, s->h_px + 2, s->w_px + 2, s->h_px + 2);
	s->in_panel = 1;
	s->words = 0;
}

void svg_end(struct svg *s)
{
	end_panel(s);
	fputs("</svg>\n", s->out);
}
