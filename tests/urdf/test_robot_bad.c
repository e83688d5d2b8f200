#define _POSIX_C_SOURCE 200809L
#include "support/read.h"
#include "support/suite.h"
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define BAD TEST_DIR "/bad"

/* What a file is answered: OK with one warning that holds `says`, or an error that does. */
struct answer {
	const char *file;
	enum rneagen_code code;
	const char *says;
};

static const struct answer answers[] = {
	/* text and XML */
	{"empty", RNEAGEN_XML, "empty.urdf: the file is empty"},
	{"not_xml", RNEAGEN_XML, "not_xml.urdf:1: not well-formed XML"},
	{"truncated", RNEAGEN_XML, "truncated.urdf:5: not well-formed XML"},
	{"unclosed", RNEAGEN_XML, "unclosed.urdf:6: not well-formed XML: no element found: the file ends too early"},
	{"mismatched", RNEAGEN_XML, "mismatched.urdf:3: not well-formed XML: mismatched tag"},
	{"encoding_declared", RNEAGEN_XML, "encoding_declared.urdf:1: the encoding \"ISO-8859-1\" is not supported"},
	{"utf16", RNEAGEN_XML, "utf16.urdf: the file is UTF-16"},
	{"utf16_no_mark", RNEAGEN_XML, "utf16_no_mark.urdf: the file is UTF-16"},
	{"latin1", RNEAGEN_XML, "latin1.urdf:1: byte 0xe9 is not UTF-8"},
	{"nul", RNEAGEN_XML, "nul.urdf: byte 292 is NUL"},
	{"doctype_entity", RNEAGEN_XML, "doctype_entity.urdf:1: a DOCTYPE"},
	{"doctype_external", RNEAGEN_XML, "doctype_external.urdf:1: a DOCTYPE"},
	{"wrong_root", RNEAGEN_URDF, "wrong_root.urdf:2: the root element is <sdf>, not <robot>"},
	{"xacro_element", RNEAGEN_XACRO, "xacro_element.urdf:6: <xacro:arm>: the file is xacro"},
	{"xacro_expression", RNEAGEN_XACRO, "xacro_expression.urdf:4: link 'arm': <mass> value=\"${m}\": "},
	{"xacro_name", RNEAGEN_XACRO, "xacro_name.urdf:6: robot 'xacro_name': <link> name=\"${prefix}hand\": "},
	{"xacro_find", RNEAGEN_XACRO, "xacro_find.urdf:5: joint 'elbow': <origin> xyz=\"$(arg offset) 0 0\": "},
	/* names */
	{"robot_no_name", RNEAGEN_URDF, "robot_no_name.urdf:2: a <robot> has no name"},
	{"no_link", RNEAGEN_URDF, "no_link.urdf: robot 'no_link' has no <link>"},
	{"link_no_name", RNEAGEN_URDF, "link_no_name.urdf:4: a <link> has no name"},
	{"link_empty_name", RNEAGEN_URDF, "link_empty_name.urdf:4: a <link> has an empty name"},
	{"joint_no_name", RNEAGEN_URDF, "joint_no_name.urdf:6: a <joint> has no name"},
	{"link_twice", RNEAGEN_URDF, "link_twice.urdf:6: link 'arm' is already defined on line 4"},
	{"joint_twice", RNEAGEN_URDF, "joint_twice.urdf:7: joint 'elbow' is already defined on line 5"},
	/* numbers and what must be there */
	{"mass_missing", RNEAGEN_URDF, "mass_missing.urdf:4: link 'arm': <inertial> has no <mass>"},
	{"inertia_missing", RNEAGEN_URDF, "inertia_missing.urdf:4: link 'arm': <inertial> has no <inertia>"},
	{"mass_no_value", RNEAGEN_URDF, "mass_no_value.urdf:4: link 'arm': <mass> has no value"},
	{"inertia_no_izz", RNEAGEN_URDF, "inertia_no_izz.urdf:4: link 'arm': <inertia> has no izz"},
	{"mass_nan", RNEAGEN_NUMBER, "mass_nan.urdf:4: link 'arm': <mass> value=\"nan\" is not a number"},
	{"mass_comma", RNEAGEN_NUMBER, "mass_comma.urdf:4: link 'arm': <mass> value=\"1,5\" is not a number"},
	{"mass_blank", RNEAGEN_NUMBER, "mass_blank.urdf:4: link 'arm': <mass> value=\"2.0 \" ends with a blank, which urdfdom"},
	{"mass_hex", RNEAGEN_NUMBER, "mass_hex.urdf:4: link 'arm': <mass> value=\"0x10\" is not a number"},
	{"mass_overflow", RNEAGEN_NUMBER, "mass_overflow.urdf:4: link 'arm': <mass> value=\"1e999\" is too large: numbers"},
	{"mass_empty", RNEAGEN_NUMBER, "mass_empty.urdf:4: link 'arm': <mass> value=\"\" is not a number"},
	{"mass_format", RNEAGEN_NUMBER, "mass_format.urdf:4: link 'arm': <mass> value=\"%s%n%s%n\" is not a number"},
	{"mass_minus", RNEAGEN_NUMBER, "mass_minus.urdf:4: link 'arm': <mass> value=\"-\" is not a number"},
	{"mass_exponent", RNEAGEN_NUMBER, "mass_exponent.urdf:4: link 'arm': <mass> value=\"1e\" is not a number"},
	{"mass_negative", RNEAGEN_NUMBER, "mass_negative.urdf:4: link 'arm': its mass -0.25 is negative"},
	{"inertia_word", RNEAGEN_NUMBER, "inertia_word.urdf:4: link 'arm': <inertia> ixy=\"zero\" is not a number"},
	{"inertial_origin_word", RNEAGEN_NUMBER,
		"inertial_origin_word.urdf:4: link 'arm': <origin> xyz=\"0 0 high\" is not three"},
	{"inertial_rpy_two", RNEAGEN_NUMBER, "inertial_rpy_two.urdf:4: link 'arm': <origin> rpy=\"0 0\" is not three"},
	{"origin_two", RNEAGEN_NUMBER, "origin_two.urdf:5: joint 'elbow': <origin> xyz=\"0 0\" is not three"},
	{"origin_joined", RNEAGEN_NUMBER, "origin_joined.urdf:5: joint 'elbow': <origin> xyz=\"1-2-3\" is not three"},
	{"origin_four", RNEAGEN_NUMBER, "origin_four.urdf:5: joint 'elbow': <origin> xyz=\"0 0 0 0\" is not three"},
	{"origin_tab", RNEAGEN_NUMBER, "origin_tab.urdf:5: joint 'elbow': <origin> holds a tab or a line break"},
	{"origin_newline", RNEAGEN_NUMBER,
		"origin_newline.urdf:5: joint 'elbow': <origin> holds a tab or a line break"},
	{"origin_quaternion", RNEAGEN_UNSUPPORTED, "origin_quaternion.urdf:5: joint 'elbow': <origin> quat_xyzw"},
	{"rpy_inf", RNEAGEN_NUMBER, "rpy_inf.urdf:5: joint 'elbow': <origin> rpy=\"0 inf 0\" is not three"},
	{"origin_overflow", RNEAGEN_NUMBER,
		"origin_overflow.urdf:5: joint 'elbow': <origin> xyz=\"0 -1e400 0\" has a number that is too large"},
	{"axis_word", RNEAGEN_NUMBER, "axis_word.urdf:5: joint 'elbow': <axis> xyz=\"z\" is not three"},
	{"axis_zero", RNEAGEN_NUMBER, "axis_zero.urdf:5: joint 'elbow': its axis is 0 0 0"},
	{"axis_zero_planar", RNEAGEN_NUMBER, "axis_zero_planar.urdf:5: joint 'elbow': its axis is 0 0 0"},
	{"axis_no_xyz", RNEAGEN_NUMBER, "axis_no_xyz.urdf:5: joint 'elbow': its axis is 0 0 0"},
	{"limit_word", RNEAGEN_NUMBER, "limit_word.urdf:5: joint 'elbow': <limit> lower=\"low\" is not a number"},
	{"limit_no_effort", RNEAGEN_URDF, "limit_no_effort.urdf:5: joint 'elbow': <limit> has no effort"},
	{"limit_missing", RNEAGEN_URDF, "limit_missing.urdf:5: joint 'elbow' is revolute and has no <limit>; add one with"},
	{"limit_missing_lines", RNEAGEN_URDF, "limit_missing_lines.urdf:5: joint 'slide' is prismatic and has no <limit>"},
	{"limit_blank", RNEAGEN_NUMBER, "limit_blank.urdf:5: joint 'elbow': <limit> effort=\"1 \" ends with a blank"},
	{"dynamics_word", RNEAGEN_NUMBER, "dynamics_word.urdf:5: joint 'elbow': <dynamics> damping=\"some\" is not a"},
	{"dynamics_empty", RNEAGEN_URDF, "dynamics_empty.urdf:5: joint 'elbow': <dynamics> has neither damping nor"},
	{"safety_word", RNEAGEN_NUMBER,
		"safety_word.urdf:5: joint 'elbow': <safety_controller> k_velocity=\"fast\" is not a number"},
	{"safety_missing", RNEAGEN_URDF, "safety_missing.urdf:5: joint 'elbow': <safety_controller> has no k_velocity; add"},
	{"calibration_word", RNEAGEN_NUMBER, "calibration_word.urdf:5: joint 'elbow': <calibration> rising=\"edge\" is not"},
	{"version_2", RNEAGEN_URDF, "version_2.urdf:2: refused by urdfdom: Invalid 'version'"},
	{"version_1", RNEAGEN_URDF, "; write version=\"1.0\", or leave it out"},
	{"type_unknown", RNEAGEN_URDF, "type_unknown.urdf:5: joint 'elbow': type \"spherical\" is unknown"},
	{"type_missing", RNEAGEN_URDF, "type_missing.urdf:5: joint 'elbow': type \"\" is unknown"},
	/* tree */
	{"parent_missing", RNEAGEN_TREE, "parent_missing.urdf:5: joint 'elbow' has no <parent>"},
	{"child_no_link", RNEAGEN_URDF, "child_no_link.urdf:5: joint 'elbow': <child> has no link"},
	{"parent_undefined", RNEAGEN_TREE, "parent_undefined.urdf:7: joint 'wrist': its parent link 'nowhere'"},
	{"child_undefined", RNEAGEN_TREE, "child_undefined.urdf:6: joint 'wrist': its child link 'nowhere'"},
	{"loop_joint", RNEAGEN_TREE, "loop_joint.urdf:8: loop_joint 'rod' closes a loop"},
	{"self_loop", RNEAGEN_TREE, "self_loop.urdf:6: joint 'wrist' joins link 'arm' to itself"},
	{"two_parents", RNEAGEN_TREE, "two_parents.urdf:8: link 'lower' is the child of two joints, 'elbow' and 'rod'"},
	{"two_roots", RNEAGEN_TREE, "two_roots.urdf:6: links 'base' and 'island' both have no parent joint"},
	{"cycle_beside_tree", RNEAGEN_TREE, "cycle_beside_tree.urdf:9: links 'y' and 'x' are in a cycle"},
	{"cycle_alone", RNEAGEN_TREE, "cycle_alone.urdf:5: links 'x' and 'y' are in a cycle"},
	/* mimic */
	{"mimic_unknown", RNEAGEN_MIMIC,
		"mimic_unknown.urdf:7: joint 'elbow' mimics joint 'ghost', which is not defined"},
	{"mimic_no_joint", RNEAGEN_URDF, "mimic_no_joint.urdf:7: joint 'elbow': <mimic> has no joint"},
	{"mimic_self", RNEAGEN_MIMIC, "mimic_self.urdf:7: joint 'elbow' mimics itself"},
	{"mimic_cycle", RNEAGEN_MIMIC, "mimic_cycle.urdf:7: joints 'elbow' and 'shoulder' mimic each other"},
	{"mimic_cycle_behind", RNEAGEN_MIMIC, "mimic_cycle_behind.urdf:7: joints 'elbow' and 'shoulder' mimic each"},
	{"mimic_of_fixed", RNEAGEN_MIMIC,
		"mimic_of_fixed.urdf:7: joint 'elbow' mimics joint 'shoulder', which is fixed"},
	{"mimic_of_floating", RNEAGEN_MIMIC, "joint 'elbow' mimics joint 'shoulder', which is floating"},
	{"mimic_of_planar", RNEAGEN_MIMIC, "joint 'elbow' mimics joint 'shoulder', which is planar"},
	{"mimic_by_planar", RNEAGEN_MIMIC, "joint 'elbow' is planar and cannot mimic joint 'shoulder'"},
	{"mimic_by_floating", RNEAGEN_MIMIC, "joint 'elbow' is floating and cannot mimic joint 'shoulder'"},
	{"mimic_word", RNEAGEN_NUMBER,
		"mimic_word.urdf:7: joint 'elbow': <mimic> multiplier=\"twice\" is not a number"},
	/* odd, but usable */
	{"odd_inertia_negative", RNEAGEN_OK,
		"odd_inertia_negative.urdf:4: link 'arm': its inertia is not positive definite (eigenvalues -1 1 3)"},
	{"odd_inertia_triangle", RNEAGEN_OK,
		"odd_inertia_triangle.urdf:4: link 'arm': its inertia violates the triangle inequality"},
	{"odd_inertia_turned", RNEAGEN_OK, "the triangle inequality (eigenvalues 1 2 4); used as given"},
	{"odd_leaf", RNEAGEN_OK, "odd_leaf.urdf:5: joint 'elbow' moves no mass: link 'arm' and all beyond have no"},
	{"odd_losses", RNEAGEN_OK, "odd_losses.urdf:5: joint 'elbow': its damping -1 is negative; used as given"},
	{"odd_axis", RNEAGEN_OK, "odd_axis.urdf:5: joint 'elbow': its axis is 5 long, not 1; normalised"},
	{"odd_follower", RNEAGEN_OK, "odd_follower.urdf:7: joint 'elbow' is fixed; its <mimic> of joint 'shoulder' is"},
	{"odd_inertials", RNEAGEN_OK, "odd_inertials.urdf:4: link 'arm': more than one <inertial>; the first is used"},
	{"odd_masses", RNEAGEN_OK, "odd_masses.urdf:4: link 'arm': more than one <mass>; the first is used"},
	{"odd_origins", RNEAGEN_OK, "odd_origins.urdf:5: joint 'elbow': more than one <origin>; the first is used"},
};

enum { ANSWER_COUNT = sizeof answers / sizeof *answers };

/* Fails unless `r` is the answer: code, text, and a message of one line that begins with the file's name. */
static void expect(const struct read *r, const struct answer *a)
{
	const char *text = r->error.message;

	ck_assert_msg(r->error.code == a->code, "%s: code %d, not %d: %s", a->file, r->error.code, a->code, text);
	if (a->code == RNEAGEN_OK) {
		ck_assert_msg(r->robot.warning_count >= 1, "%s: no warning", a->file);
		text = r->robot.warnings[0];
	}
	ck_assert_msg(strstr(text, a->says) != NULL, "%s: \"%s\" lacks \"%s\"", a->file, text, a->says);
	ck_assert_msg(
		!strncmp(text, a->file, strlen(a->file)), "%s: \"%s\" does not begin with the file", a->file, text);
	ck_assert_msg(!strchr(text, '\n'), "%s: more than one line", a->file);
}

START_TEST(bad_file)
{
	const struct answer *a = &answers[_i];
	char name[256];
	struct read r;

	snprintf(name, sizeof name, "%s.urdf", a->file);
	read_robot(&r, BAD, name);
	expect(&r, a);
	if (a->code == RNEAGEN_OK)
		ck_assert_uint_eq(r.robot.warning_count, 1);
	read_free(&r);
}
END_TEST

START_TEST(every_bad_file_has_an_answer)
{
	int count;
	char **names = names_list(BAD, &count);

	ck_assert_int_eq(count, ANSWER_COUNT);
	names_free(names);
}
END_TEST

/* A library prints nothing: what comes out on stdout and stderr while all bad files are read. */
START_TEST(nothing_is_printed)
{
	FILE *caught = tmpfile();
	int count, saved[2] = {dup(1), dup(2)};
	char **names = names_list(BAD, &count);

	ck_assert_ptr_nonnull(caught);
	fflush(NULL);
	dup2(fileno(caught), 1);
	dup2(fileno(caught), 2);
	for (int i = 0; i < count; i++) {
		struct read r;

		read_robot(&r, BAD, names[i]);
		read_free(&r);
	}
	fflush(NULL);
	dup2(saved[0], 1);
	dup2(saved[1], 2);
	ck_assert_int_eq(fseek(caught, 0, SEEK_END), 0);
	ck_assert_int_eq(ftell(caught), 0);
	fclose(caught);
	names_free(names);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("robot: bad files");
	TCase *tc = tcase_create("files");

	tcase_add_loop_test(tc, bad_file, 0, ANSWER_COUNT);
	tcase_add_test(tc, every_bad_file_has_an_answer);
	tcase_add_test(tc, nothing_is_printed);
	suite_add_tcase(suite, tc);
	return suite_run(suite);
}
