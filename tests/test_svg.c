/* SPDX-License-Identifier: MIT
 * Charts as SVG: round numbers on the axes, every point where it belongs, gaps as gaps, text that cannot break the file.
 */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../tools/svg.c"
#include "../tools/svg_axis.c"
#include "../tools/svg_marks.c"

/* A panel of 10 px a unit in x and y, 0..50 and 0..20, and what is drawn into it. */
struct drawn {
	struct svg s;
	char *text;
	size_t size;
};

static void begin(struct drawn *d, enum svg_scale y_scale)
{
	d->s = (struct svg){.out = open_memstream(&d->text, &d->size),
			    .x = {.min = 0, .max = 50},
			    .y = {.min = y_scale == SVG_LOG ? 0.01 : 0,
				  .max = y_scale == SVG_LOG ? 1 : 20,
				  .scale = y_scale},
			    .w_px = 500,
			    .h_px = 200};
	assert_non_null(d->s.out);
}

static int count(const char *text, const char *what)
{
	int n = 0;

	for (text = strstr(text, what); text; text = strstr(text + 1, what)) {
		n++;
	}
	return n;
}

static void end(struct drawn *d)
{
	assert_int_equal(fclose(d->s.out), 0);
}

/* ---- axes -------------------------------------------------------------------------------------- */

static void expect_ticks(const struct svg_axis *a, double px, double gap_px, const double *want,
			 int n)
{
	double at[SVG_TICKS];

	assert_int_equal(svg_ticks(a, px, gap_px, at), n);
	for (int i = 0; i < n; i++) {
		assert_true(fabs(at[i] - want[i]) <= 1e-9 * fabs(want[i]));
	}
}

static void test_ticks(void **state)
{
	double at[SVG_TICKS];

	(void)state;
	expect_ticks(&(struct svg_axis){.min = 0, .max = 30}, 100, 20, (double[]){0, 10, 20, 30},
		     4);
	expect_ticks(&(struct svg_axis){.min = -6, .max = 0}, 100, 26, (double[]){-6, -4, -2, 0},
		     4);
	expect_ticks(&(struct svg_axis){.min = 17.1, .max = 23.4}, 640, 64,
		     (double[]){18, 19, 20, 21, 22, 23}, 6);
	expect_ticks(&(struct svg_axis){.min = 0, .max = 0.035, .unit = 0.01}, 150, 26,
		     (double[]){0, 0.01, 0.02, 0.03}, 4);
	expect_ticks(&(struct svg_axis){.min = 1e-4, .max = 1, .scale = SVG_LOG}, 400, 26,
		     (double[]){1e-4, 1e-3, 1e-2, 0.1, 1}, 5);
	expect_ticks(&(struct svg_axis){.min = 1e-9, .max = 1, .scale = SVG_LOG}, 100, 20,
		     (double[]){1e-9, 1e-7, 1e-5, 1e-3, 0.1}, 5);
	expect_ticks(&(struct svg_axis){.min = 10, .max = 100, .scale = SVG_LOG}, 400, 26,
		     (double[]){10, 20, 50, 100}, 4);
	expect_ticks(&(struct svg_axis){.scale = SVG_NAMES, .n = 3}, 10, 64, (double[]){0, 1, 2},
		     3);
	assert_true(svg_ticks(&(struct svg_axis){.min = 1e300, .max = 1.0000000000000002e300}, 1e5,
			      1e-9, at) <= SVG_TICKS);
	assert_true(svg_ticks(&(struct svg_axis){.max = 1e6}, 1e5, 1e-9, at) <= SVG_TICKS);
	assert_true(svg_ticks(&(struct svg_axis){.min = 1e-300, .max = 1e300, .scale = SVG_LOG},
			      1e5, 1e-9, at) <= SVG_TICKS);
}

static void expect_number(const struct svg_axis *a, double v, double step, const char *want)
{
	char text[SVG_TICK_MAX];

	svg_tick_text(a, v, step, text);
	assert_string_equal(text, want);
}

static void test_numbers(void **state)
{
	const struct svg_axis linear = {.min = -1, .max = 1}, percent = {.max = 1, .unit = 0.01},
			      wide = {.min = 1e-7, .max = 1e12, .scale = SVG_LOG},
			      narrow = {.min = 1e4, .max = 1e6, .scale = SVG_LOG};

	(void)state;
	expect_number(&linear, 20, 10, "20");
	expect_number(&linear, -0.25, 0.05, "-0.25");
	expect_number(&linear, -1e-17, 0.5, "0.0");
	expect_number(&percent, 0.05, 0.05, "5");
	expect_number(&percent, 0.005, 0.005, "0.5");
	expect_number(&wide, 1e-7, 0, "10⁻⁷");
	expect_number(&wide, 1e-3, 0, "0.001");
	expect_number(&wide, 1000, 0, "1000");
	expect_number(&wide, 1e4, 0, "10⁴");
	expect_number(&wide, 1e12, 0, "10¹²");
	expect_number(&narrow, 20000, 0, "20000");
}

static void expect_round(double min, double max, enum svg_scale scale, double want_min,
			 double want_max)
{
	struct svg_axis a = {.min = min, .max = max, .scale = scale};

	svg_round_out(&a);
	assert_true(fabs(a.min - want_min) <= 1e-9 * fabs(want_min));
	assert_true(fabs(a.max - want_max) <= 1e-9 * fabs(want_max));
}

static void test_round_out(void **state)
{
	(void)state;
	expect_round(0.3, 22.4, SVG_LINEAR, 0, 25);
	expect_round(-5.9, 0, SVG_LINEAR, -6, 0);
	expect_round(34, 165, SVG_LINEAR, 20, 180);
	expect_round(7, 7, SVG_LINEAR, 7, 7.7);
	expect_round(0, 0, SVG_LINEAR, 0, 0.5);
	expect_round(INFINITY, -INFINITY, SVG_LINEAR, 0, 1);
	expect_round(3e-4, 0.5, SVG_LOG, 1e-4, 1);
	expect_round(10, 10, SVG_LOG, 10, 100);
	expect_round(INFINITY, -INFINITY, SVG_LOG, 0.1, 1);
	expect_round(0, 10, SVG_LOG, 1e-5, 10);
	expect_round(-2, -1, SVG_LOG, 0.1, 1);
}

static void expect_sane(double min, double max, enum svg_scale scale, double want_min,
			double want_max)
{
	const struct svg_axis a = {.min = min, .max = max, .scale = scale};
	const struct svg_axis sane = svg_axis_sane(&a);

	assert_true(sane.min == want_min && sane.max == want_max);
}

static void test_sane(void **state)
{
	(void)state;
	expect_sane(-2, 5, SVG_LINEAR, -2, 5);
	expect_sane(5, 5, SVG_LINEAR, 0, 1);
	expect_sane(NAN, 5, SVG_LINEAR, 0, 1);
	expect_sane(0, INFINITY, SVG_LINEAR, 0, 1);
	expect_sane(0.5, 5, SVG_LOG, 0.5, 5);
	expect_sane(0, 5, SVG_LOG, 0.1, 1);
	expect_sane(0, 0, SVG_NAMES, 0, 0);
}

static void test_cover(void **state)
{
	const double v[] = {3, NAN, -INFINITY, 7, 5};
	double min = INFINITY, max = -INFINITY;

	(void)state;
	svg_cover(v, 5, &min, &max);
	assert_true(min == 3 && max == 7);
	svg_cover(v + 1, 2, &min, &max);
	assert_true(min == 3 && max == 7);
}

static void test_gap(void **state)
{
	const double x[] = {0, 1, 2, 3.5, 10, 11, 12.5, 30};

	(void)state;
	assert_true(fabs(svg_gap(x, 8) - 6) < 1e-9); /* steps 1 1 1.5 6.5 1 1.5 17.5 */
	assert_true(fabs(svg_gap(x, 2) - 4) < 1e-9);
	assert_true(svg_gap(x, 1) == 0 && svg_gap(NULL, 0) == 0);
}

static void test_places(void **state)
{
	struct svg s = {.x = {.min = 0, .max = 50},
			.y = {.min = 0.01, .max = 1, .scale = SVG_LOG},
			.w_px = 500,
			.h_px = 200};

	(void)state;
	assert_true(svg_at_x(&s, 25) == 250);
	assert_true(fabs(svg_at_y(&s, 0.1) - 100) < 1e-9);
	assert_true(svg_at_y(&s, 1) == 0);
	assert_true(svg_at_y(&s, 0) > 200 && svg_at_y(&s, -3) > 200); /* below the plot */
	assert_true(svg_at_x(&s, 1e30) == 1e4 && svg_at_x(&s, -1e30) == -1e4);
	s.y = (struct svg_axis){.scale = SVG_NAMES, .n = 2};
	assert_true(svg_at_y(&s, 0) == 50 && svg_at_y(&s, 1) == 150);
}

/* ---- text -------------------------------------------------------------------------------------- */

static void expect_escaped(const char *text, const char *want)
{
	struct drawn d;

	begin(&d, SVG_LINEAR);
	svg_escape(d.s.out, text);
	end(&d);
	assert_string_equal(d.text, want);
	free(d.text);
}

static void test_escape(void **state)
{
	(void)state;
	expect_escaped("a < b && \"c\" > d", "a &lt; b &amp;&amp; &quot;c&quot; &gt; d");
	expect_escaped("5 m/s², ±1, 速, 😀", "5 m/s², ±1, 速, 😀");
	expect_escaped("a\tb\x01\x7f", "a?b??");
	expect_escaped("\xff\xfe", "??");
	expect_escaped("cut \xc3", "cut ?");
	expect_escaped("\xc0\xaf \xe0\x80\xaf \xed\xa0\x80 \xf0\x80\x80\xaf \xf4\x90\x80\x80",
		       "?? ??? ??? ???? ????"); /* overlong, surrogate, beyond */
}

/* ---- marks ------------------------------------------------------------------------------------- */

static void test_line(void **state)
{
	const double x[] = {0, 10, 20, 30, 40}, y[] = {0, 10, NAN, 10, 20};
	struct drawn d;

	(void)state;
	begin(&d, SVG_LINEAR);
	svg_line(&d.s, SVG_RED, SVG_SOLID, x, y, 5);
	end(&d);
	assert_string_equal(
		d.text,
		"<path class=\"c1 l\" d=\"M0.0 200.0L100.0 100.0M300.0 100.0L400.0 0.0\"/>\n");
	free(d.text);
	begin(&d, SVG_LINEAR);
	svg_line(&d.s, SVG_RED, SVG_STEP, x, y, 2);
	svg_line(&d.s, SVG_RED, SVG_DASHED, x, y, 0);
	end(&d);
	assert_string_equal(d.text, "<path class=\"c1 l\" d=\"M0.0 200.0H100.0V100.0\"/>\n<path "
				    "class=\"c1 l t\" d=\"\"/>\n");
	free(d.text);
}

/* What is missing is not made up. */
static void test_hole(void **state)
{
	const double x[] = {0, 10, 10.01, 30, 40}, y[] = {0, 10, 10, 10, 20},
		     lo[] = {0, 0, 0, 0, 0};
	struct drawn d;

	(void)state;
	begin(&d, SVG_LINEAR);
	d.s.x.gap = 15;
	svg_line(&d.s, SVG_RED, SVG_STEP, x, y, 5);
	svg_band(&d.s, SVG_RED, x, lo, y, 5);
	end(&d);
	assert_string_equal(d.text, "<path class=\"c1 l\" d=\"M0.0 200.0H100.0V100.0H100.1V100.0"
				    "M300.0 100.0H400.0V0.0\"/>\n<path class=\"c1 b\" d=\""
				    "M0.0 200.0L100.0 100.0L100.1 200.0L0.0 200.0Z"
				    "M300.0 100.0L400.0 0.0L400.0 200.0L300.0 200.0Z\"/>\n");
	free(d.text);
	d.s.x.gap = 20;
	assert_true(svg_goes_on(&d.s, 10, 30) && !svg_goes_on(&d.s, 10, 30.1));
	d.s.x.gap = 0;
	assert_true(svg_goes_on(&d.s, 10, 1e9));
}

#define MANY 100000

static double many_x[MANY], many_y[MANY], many_lo[MANY];

static void test_many_points(void **state)
{
	struct drawn d;

	(void)state;
	for (int i = 0; i < MANY; i++) {
		many_x[i] = 50.0 * i / MANY;
		many_y[i] = 10 + (i % 3);
		many_lo[i] = 5 - (i % 3);
	}
	many_y[54321] = 20;
	many_y[54323] = 0;
	many_lo[54322] = 0;
	begin(&d, SVG_LINEAR);
	svg_line(&d.s, SVG_BLUE, SVG_SOLID, many_x, many_y, MANY);
	end(&d);
	assert_true(d.size < 100000); /* four points for each half pixel */
	assert_int_equal(count(d.text, " 0.0"), 1);
	assert_int_equal(count(d.text, " 200.0"), 1);
	assert_non_null(strstr(d.text, "M0.0 100.0"));
	assert_int_equal(count(d.text, "M"), 1);
	free(d.text);
	begin(&d, SVG_LINEAR);
	svg_band(&d.s, SVG_BLUE, many_x, many_lo, many_y, MANY);
	end(&d);
	assert_true(d.size < 100000);
	assert_int_equal(count(d.text, " 0.0"), 1);
	assert_int_equal(count(d.text, " 200.0"), 1);
	free(d.text);
}

static void test_band(void **state)
{
	const double x[] = {0, 10, 20, 30, 40}, lo[] = {0, 5, 5, NAN, 5},
		     hi[] = {5, 10, 10, 10, 10};
	struct drawn d;

	(void)state;
	begin(&d, SVG_LINEAR);
	svg_band(&d.s, SVG_BLUE, x, lo, hi, 5);
	end(&d);
	assert_string_equal(d.text,
			    "<path class=\"c0 b\" d=\"M0.0 150.0L100.0 100.0L200.0 100.0"
			    "L200.0 150.0L100.0 150.0L0.0 200.0ZM400.0 100.0L400.0 150.0Z\"/>\n");
	free(d.text);
}

static void test_dots_and_bars(void **state)
{
	const double x[] = {10, 20, 30, 40}, y[] = {1, NAN, 0, 0.1};
	struct drawn d;

	(void)state;
	begin(&d, SVG_LOG);
	svg_dots(&d.s, SVG_GREEN, x, y, 4);
	end(&d);
	assert_int_equal(count(d.text, "h0"), 3); /* the third below the plot */
	assert_non_null(strstr(d.text, "M400.0 100.0h0"));
	free(d.text);
	begin(&d, SVG_LOG);
	svg_bars(&d.s, SVG_GREEN, x, y, 4, 2);
	end(&d);
	assert_string_equal(d.text, "<path class=\"c2 f\" d=\"M90.0 200.0V0.0H110.0V200.0Z"
				    "M390.0 200.0V100.0H410.0V200.0Z\"/>\n");
	free(d.text);
}

static void test_span(void **state)
{
	struct drawn d;

	(void)state;
	begin(&d, SVG_LINEAR);
	d.s.y = (struct svg_axis){.scale = SVG_NAMES, .n = 2};
	svg_span(&d.s, SVG_AMBER, 1, 10, 30, "warn");
	end(&d);
	assert_non_null(strstr(
		d.text,
		"x=\"100.0\" y=\"112.0\" width=\"200.0\" height=\"76.0\"><title>warn</title>"));
	assert_non_null(strstr(d.text, "text-anchor=\"middle\">warn</text>"));
	free(d.text);
	begin(&d, SVG_LINEAR);
	d.s.y = (struct svg_axis){.scale = SVG_NAMES, .n = 2};
	svg_span(&d.s, SVG_AMBER, 0, 10, 10.5, "warn"); /* too short for the word */
	svg_span(&d.s, SVG_AMBER, 0, 60, 70, "off");
	svg_span(&d.s, SVG_AMBER, 0, 0, NAN, "never");
	end(&d);
	assert_int_equal(count(d.text, "<rect"), 1);
	assert_int_equal(count(d.text, "<text"), 0);
	assert_non_null(strstr(d.text, "<title>warn</title>"));
	free(d.text);
}

static void test_words(void **state)
{
	struct drawn d;

	(void)state;
	begin(&d, SVG_LINEAR);
	svg_level(&d.s, SVG_RED, 10, "half");
	svg_level(&d.s, SVG_RED, 19.9, "top"); /* no room above it */
	svg_mark(&d.s, SVG_RED, 5, "first");
	svg_mark(&d.s, SVG_RED, 49.9, "second"); /* no room on its right */
	svg_mark(&d.s, SVG_RED, 20, NULL);
	end(&d);
	assert_non_null(strstr(d.text, "x=\"495.0\" y=\"96.0\" text-anchor=\"end\">half"));
	assert_non_null(strstr(d.text, "y=\"14.0\" text-anchor=\"end\">top"));
	assert_non_null(strstr(d.text, "x=\"55.0\" y=\"14.0\">first"));
	assert_non_null(strstr(d.text, "x=\"494.0\" y=\"28.0\" text-anchor=\"end\">second"));
	assert_int_equal(count(d.text, "<text"), 4);
	free(d.text);
}

/* ---- page -------------------------------------------------------------------------------------- */

static void draw_page(FILE *out, int embedded)
{
	const struct svg_page page = {.width_px = 600,
				      .height_px = 400,
				      .title = "A & B",
				      .subtitle = "below",
				      .note = "foot",
				      .shares = 2,
				      .embedded = embedded};
	static const struct svg_key key[] = {{SVG_BLUE, SVG_KEY_LINE, "one"},
					     {SVG_RED, SVG_KEY_DASHED, "two"},
					     {SVG_GREEN, SVG_KEY_DOT, "three"},
					     {SVG_SKY, SVG_KEY_AREA, "four"},
					     {SVG_GREY, SVG_KEY_BAR, "five"}};
	const struct svg_panel upper = {.x = {.max = 1},
					.y = {.label = "up", .max = 1},
					.title = "Upper",
					.key = key,
					.keys = 5};
	const struct svg_panel lower = {.x = {.label = "time [s]", .max = 1}, .y = {.max = 1}};
	struct svg s = svg_start(out, &page);

	svg_panel(&s, &upper);
	assert_true(s.y_px > 42 && s.y_px + s.h_px <= 210);
	svg_legend(&s, key, 5);
	const double x_px = s.x_px, w_px = s.w_px, below_px = s.y_px + s.h_px;

	svg_panel(&s, &lower);
	assert_true(s.x_px == x_px && s.w_px == w_px); /* one time axis for both */
	assert_true(s.y_px > below_px && s.y_px + s.h_px + NUMBERS_PX <= 400 - NOTE_PX);
	svg_end(&s);
}

static void test_page(void **state)
{
	struct drawn d;

	(void)state;
	for (int embedded = 0; embedded <= 1; embedded++) {
		begin(&d, SVG_LINEAR);
		draw_page(d.s.out, embedded);
		end(&d);
		assert_int_equal(count(d.text, "<svg"), 3);
		assert_int_equal(count(d.text, "</svg>"), 3);
		assert_int_equal(count(d.text, "<style>"), !embedded);
		assert_int_equal(count(d.text, "prefers-color-scheme:dark"), !embedded);
		assert_int_equal(count(d.text, "A &amp; B"), 2);
		assert_int_equal(count(d.text, ">0.0<"), 3); /* no numbers below the upper panel */
		assert_int_equal(count(d.text, ">three<"), 2);
		assert_int_equal(count(d.text, "http"), 1); /* the name of the format alone */
		free(d.text);
	}
}

static void test_full_disk(void **state)
{
	FILE *f = fopen("/dev/full", "w");

	(void)state;
	assert_non_null(f);
	draw_page(f, 0);
	fflush(f);
	assert_true(ferror(f));
	fclose(f);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_ticks),         cmocka_unit_test(test_numbers),
		cmocka_unit_test(test_round_out),     cmocka_unit_test(test_cover),
		cmocka_unit_test(test_sane),          cmocka_unit_test(test_places),
		cmocka_unit_test(test_escape),        cmocka_unit_test(test_line),
		cmocka_unit_test(test_hole),          cmocka_unit_test(test_gap),
		cmocka_unit_test(test_many_points),   cmocka_unit_test(test_band),
		cmocka_unit_test(test_dots_and_bars), cmocka_unit_test(test_span),
		cmocka_unit_test(test_words),         cmocka_unit_test(test_page),
		cmocka_unit_test(test_full_disk),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
