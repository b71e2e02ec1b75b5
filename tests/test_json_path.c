/* SPDX-License-Identifier: MIT
 * The JSON reader of aebmc top: what is there is found, what is not or is no JSON is not.
 */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>
#include "../tools/json_path.c"

static const char doc[] =
	"{\"a\":1.5,\"ab\":\"x\",\"b\":{\"a\":true,\"c\":{\"d\":\"say \\\"hi\\\" \\\\ \\u0007\"}},"
	"\"e\":[],\"f\":[{\"n\":\"can0\"},{\"n\":\"can1\",\"up\":false}],\"g\":null, \"h\" : [ 1 , "
	"2 ] ,"
	"\"k\":{},\"l\":-3e-5}\n";

static void expect(const char *path, const char *want)
{
	char value[64];

	assert_int_equal(json_path_text(doc, path, value, sizeof(value)), 0);
	assert_string_equal(value, want);
}

static void test_found(void **state)
{
	(void)state;
	expect("a", "1.5");
	expect("ab", "x");
	expect("b.a", "true");
	expect("b.c.d", "say \"hi\" \\ ?");
	expect("f.0.n", "can0");
	expect("f.1.n", "can1");
	expect("f.1.up", "false");
	expect("g", "");
	expect("h.1", "2");
	expect("l", "-3e-5");
}

static void test_not_there(void **state)
{
	static const char *const path[] = {"z",   "b.z",    "a.b", "f.2.n",
					   "e.0", "f.0.up", "k.a", "b.c.d.e"};
	char value[8] = "as was";

	(void)state;
	for (size_t i = 0; i < sizeof(path) / sizeof(path[0]); i++) {
		assert_int_equal(json_path_text(doc, path[i], value, sizeof(value)), -ENOENT);
		assert_string_equal(value, "as was");
	}
	assert_int_equal(json_path_text(doc, "b", value, sizeof(value)), -EINVAL);
	assert_int_equal(json_path_text(doc, "f", value, sizeof(value)), -EINVAL);
}

static void test_no_json(void **state)
{
	static const char *const text[] = {"",
					   "{",
					   "{\"z\"",
					   "{\"z\":",
					   "{\"z\":\"",
					   "{\"z\":{",
					   "{\"y\":[1,\"z\":1}",
					   "{\"y\":{\"a\":1 \"z\":2",
					   "{\"y\" 1,\"z\":2}",
					   "[",
					   "\"\\",
					   "{\"y\":,\"z\":1}",
					   "{\"z\":[1,2}"};
	char value[8];

	(void)state;
	for (size_t i = 0; i < sizeof(text) / sizeof(text[0]); i++) {
		assert_int_equal(json_path_text(text[i], "z", value, sizeof(value)), -ENOENT);
	}
}

/* Every prefix of the document: never read beyond its end (in a block of exactly its size, for the sanitizers). */
static void test_cut_anywhere(void **state)
{
	char value[8];

	(void)state;
	for (size_t n = 0; n < sizeof(doc) - 3; n++) {
		char *cut = malloc(n + 1);

		memcpy(cut, doc, n);
		cut[n] = '\0';
		assert_int_equal(json_path_text(cut, "m", value, sizeof(value)), -ENOENT);
		free(cut);
	}
}

static void test_too_deep(void **state)
{
	char text[2 * JSON_PATH_DEPTH_MAX + 80] = "{\"a\":";
	char value[8];

	(void)state;
	memset(text + 5, '[', JSON_PATH_DEPTH_MAX + 10);
	memset(text + 5 + JSON_PATH_DEPTH_MAX + 10, ']', JSON_PATH_DEPTH_MAX + 10);
	strcat(text, ",\"z\":1}");
	assert_int_equal(json_path_text(text, "z", value, sizeof(value)), -ENOENT);
}

static void test_cut_to_size(void **state)
{
	char value[3];

	(void)state;
	assert_int_equal(json_path_text(doc, "f.0.n", value, sizeof(value)), 0);
	assert_string_equal(value, "ca");
}

/* The last key may have dots, as in the levels of a curve. */
static void test_dotted_key(void **state)
{
	static const char levels[] = "{\"at\":{\"0.05\":100,\"0\":{\"1\":7}}}";
	char value[8];

	(void)state;
	assert_int_equal(json_path_text(levels, "at.0.05", value, sizeof(value)), 0);
	assert_string_equal(value, "100");
	assert_int_equal(json_path_text(levels, "at.0.1", value, sizeof(value)), 0);
	assert_string_equal(value, "7");
	assert_int_equal(json_path_text(levels, "at.0.2", value, sizeof(value)), -ENOENT);
}

static void test_members(void **state)
{
	const char *m = json_path_first(json_path(doc, "f"));
	char value[8];

	(void)state;
	assert_int_equal(json_path_text(m, "n", value, sizeof(value)), 0);
	assert_string_equal(value, "can0");
	m = json_path_next(m);
	assert_int_equal(json_path_text(m, "n", value, sizeof(value)), 0);
	assert_string_equal(value, "can1");
	assert_null(json_path_next(m));
	assert_null(json_path_first(json_path(doc, "e")));
	assert_null(json_path_first(json_path(doc, "b")));
}

static void test_whole(void **state)
{
	char cut[sizeof(doc)];

	(void)state;
	assert_true(json_path_whole(doc));
	for (size_t n = 0; n < strlen(doc) - 1; n++) { /* all but the blank at its end */
		memcpy(cut, doc, n);
		cut[n] = '\0';
		assert_false(json_path_whole(cut));
	}
	assert_false(json_path_whole("{} {}"));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_found),      cmocka_unit_test(test_not_there),
		cmocka_unit_test(test_no_json),    cmocka_unit_test(test_cut_anywhere),
		cmocka_unit_test(test_too_deep),   cmocka_unit_test(test_cut_to_size),
		cmocka_unit_test(test_dotted_key), cmocka_unit_test(test_members),
		cmocka_unit_test(test_whole),
	};

	return cmocka_run_group_tests(tests, NULL, NULL);
}
