#include <sinew.h>
#include <stdio.h>
int main(void) {
    char why[256];
    sinew_robot *robot = NULL;
    if (sinew_robot_open("robots/biorob-like", &robot, why, sizeof why) != SINEW_STATUS_OK) return puts(why), 1;
    for (size_t i = 0; i < sinew_robot_joints(robot); i++)
        printf("%-15s 10 mrad are %.3f mm\n", sinew_robot_joint_name(robot, i), 1e3 * sinew_robot_elongation_m(robot, i, 0.01));
    sinew_robot_free(robot);
}
