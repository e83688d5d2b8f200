/* What cannot be had of where things are is refused by a message that names it. Would catch a link that is guessed, and
   a frame that is read in part. */
#include "rneagen.h"
#include "support/read.h"
#include "support/suite.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct refusal {
	const char *robot, *scene, *says;
} REFUSALS[] = {
	{"panda", "want pose.panda_hnad\n", "no link 'panda_hnad'; did you mean 'panda_hand'?"},
	{"panda", "add-frame tip=panda_hnad,1,2,3,4,5,6\nwant pose.tip\n", "no link 'panda_hnad'; did you mean 'panda_hand'?"},
	{"panda", "add-frame tip=panda_hand,1,2,3,4,5,6\nwant pose.tp\n", "no link 'tp'"},
	{"panda", "add-frame tip=panda_hand,1,2,3,4,5\nwant pose.tip\n", "has 5 numbers"},
	{"panda", "add-frame tip=panda_hand,1,2,3,4,5,6,7\nwant pose.tip\n", "has 7 numbers"},
	{"panda", "add-frame tip=panda_hand,1,2,3,4,5,x\nwant pose.tip\n", "finite numbers"},
	{"panda", "add-frame tip=panda_hand,1,2,3,4,5,nan\nwant pose.tip\n", "finite numbers"},
	{"panda", "add-frame tip\nwant pose.tip\n", "add-frame"},
	{"panda", "add-frame panda_hand=panda_link3,1,2,3,4,5,6\nwant pose.panda_hand\n", "'panda_hand'"},
	{"panda", "add-frame tip=panda_hand,1,2,3,4,5,6\nadd-frame tip=panda_hand,1,2,3,4,5,6\nwant pose.tip\n",
		"frame 'tip' already"},
	{"hyq", "tip lf_foot\nwant pose.rf_foot\n", "link 'rf_foot' does not move"},
	{"hyq", "tip lf_foot\nbeside drop\nwant jacobian.rf_foot\n", "'rf_foot'"},
	{"panda", "root panda_link4\nwant pose.panda_link2\n", "link 'panda_link2' is not part"},
	{"panda", "want jacobian.panda_link0\n", "link 'panda_link0' does not move"},
	{"panda", "want opspace.panda_link2\n", "opspace_inv.panda_link2"},
	{"panda", "want pose\n", "needs a name"},
	{"panda", "want com.panda_hand\n", "takes no name"},
	{"panda", "want pose.panda_hand,pose.panda_hand\n", "already"},
	{"panda", "want pose.panda_hand\nframe base\n", "'base'"},
	{"panda", "want pose.panda_hand\npose euler\n", "'euler'"},
	{"panda", "want jacobain.panda_hand\n", "did you mean 'jacobian"},
	/* links that stand */
	{"hyq", "contact lf_foot\n", "take --want qdd"},
	{"hyq", "contact lf_fot\nwant qdd\n", "did you mean 'lf_foot'?"},
	{"hyq", "contact lf_foot\nweld lf_foot\nwant qdd\n", "'lf_foot' stands already"},
	{"hyq", "want qdd,contact.lf_foot\n", "'lf_foot' does not stand in this scene: --contact lf_foot"},
	{"hyq", "contact lf_foot\nwant qdd,weld.lf_foot\n", "want contact.lf_foot"},
	{"hyq", "contact lf_foot\nwant qdd,Minv\n", "'Minv' is of the robot that nothing holds"},
	{"hyq", "contact lf_foot\nwant qdd,qdd_bound\n", "'qdd_bound'"},
	{"hyq", "contact lf_foot\nwant qdd,opspace_inv.rf_foot\n", "'opspace_inv.rf_foot' speaks of no links that stand"},
	{"hyq", "contact lf_foot\nwant qdd,contact.lf_kfe_joint\n", "'lf_kfe_joint' does not stand in this scene"},
	{"hyq", "contact lf_lowerleg\nwant qdd,contact.lf_kfe_joint\n", "stands as 'lf_lowerleg': want contact.lf_lowerleg"},
	{"panda", "add-frame left=panda_hand,0,0.1,0,0,0,0\nadd-frame right=panda_hand,0,-0.1,0,0,0,0\ncontact left,right\nwant qdd\n",
		"take --weld"},
	{"hyq", "contact lf_foot\nwant qdd\nframe world\n", "world-aligned"},
	{"hyq", "contact lf_foot\nwant qdd,dqdd_dq\nderivatives recursion\n", "forward"},
	{"hyq", "contact lf_foot\nwant qdd\nfree accel.rf_foot\n", "'rf_foot' does not stand"},
	{"hyq", "weld lf_foot\nwant qdd\n", "'lf_foot' cannot stand so in any state"}, /* a leg on the ground has three joints */
	{"panda", "contact panda_hand,panda_link7,panda_link6\nwant qdd\n", "'panda_link7' cannot stand beside 'panda_hand'"},
	{"panda", "contact panda_hand,panda_link6,panda_link5\nwant qdd\n", "hold it already"},
	{"panda", "contact panda_link0\nwant qdd\n", "'panda_link0' does not move"},
};
enum { COUNT = sizeof REFUSALS / sizeof *REFUSALS };

START_TEST(refused)
{
	const struct refusal *x = &REFUSALS[_i];
	struct rneagen_options o = rneagen_options_default();
	struct rneagen_result text;
	struct rneagen_error e;
	char *urdf = robot_text(x->robot);

	o.scene = x->scene;
	ck_assert_msg(rneagen_generate(urdf, strlen(urdf), &o, &text, &e), "not refused: %s", x->scene);
	ck_assert_msg(strstr(e.message, x->says) != NULL, "%s: says '%s', not '%s'", x->scene, e.message, x->says);
	free(urdf);
}
END_TEST

int main(void)
{
	Suite *suite = suite_create("kinematics refused");

	suite_add(suite, "refused", refused, COUNT, 60);
	return suite_run(suite);
}
