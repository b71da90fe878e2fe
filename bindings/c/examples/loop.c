/* Offsets in a control loop, in C:
 *
 *     loop ROBOT_DIR BASELINE [SAVE] < samples
 *
 * Standard input replaces the robot: one line per sample with its time, s, the joint positions and the motor
 * positions, rad, in the robot's order; `nan` is a missing motor position. SAVE is the file of the next baseline.
 *
 * Nothing between "Sample" and "Work" allocates, locks, waits or prints: it may run in a control thread. */
#include <sinew.h>

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#define MOST_JOINTS 64
/* Interval of the output, s. */
static const double PRINT_S = 10.0;

/* Reads a file as a text that the caller frees; null on failure. */
static char *text_of(const char *path) {
    FILE *file = fopen(path, "rb");
    if (file == NULL) return NULL;
    char *text = NULL;
    if (fseek(file, 0, SEEK_END) == 0) {
        const long length = ftell(file);
        rewind(file);
        if (length >= 0) text = malloc((size_t)length + 1);
        if (text != NULL) text[fread(text, 1, (size_t)length, file)] = '\0';
    }
    fclose(file);
    return text;
}

/* Reads the next sample; false at the end of the input. */
static bool sample_of(FILE *robot, size_t joints, double *t_s, double *q, double *theta) {
    if (fscanf(robot, "%lf", t_s) != 1) return false;
    for (size_t i = 0; i < joints; i++)
        if (fscanf(robot, "%lf", &q[i]) != 1) return false;
    for (size_t i = 0; i < joints; i++)
        if (fscanf(robot, "%lf", &theta[i]) != 1) return false;
    return true;
}

/* Prints the offsets with their 95 % intervals, and the reasons for provisional ones. */
static void print(const sinew_robot *robot, sinew_offsets *offsets, double since_s) {
    sinew_offset of_joints[MOST_JOINTS];
    const size_t joints = sinew_robot_joints(robot);
    if (sinew_offsets_read(offsets, NULL, of_joints, joints) != SINEW_STATUS_OK) return;
    printf("%6.1f s", since_s);
    for (size_t i = 0; i < joints; i++) {
        const sinew_offset *offset = &of_joints[i];
        const char *name = sinew_robot_joint_name(robot, i);
        printf("  %s %+.2f ± %.2f", name, 1e3 * offset->offset_rad, 1.96e3 * offset->offset_std_rad);
        if (offset->provisional != SINEW_PROVISIONAL_NONE)
            printf(" (%s)", sinew_provisional_text((int)offset->provisional));
    }
    printf(" mrad\n");
}

/* Writes the last solution: the baseline of the next session. */
static int save(sinew_offsets *offsets, double end_s, const char *path) {
    const int64_t end_ns = (int64_t)(end_s * 1e9);
    size_t length = 0;
    sinew_status status = sinew_offsets_save(offsets, "loop", end_ns, NULL, 0, &length);
    char *text = status == SINEW_STATUS_SHORT ? malloc(length) : NULL;
    if (text != NULL) status = sinew_offsets_save(offsets, "loop", end_ns, text, length, NULL);
    FILE *file = status == SINEW_STATUS_OK ? fopen(path, "wb") : NULL;
    const bool written = file != NULL && fputs(text, file) >= 0;
    const bool closed = file != NULL && fclose(file) == 0;
    free(text);
    if (written && closed) return EXIT_SUCCESS;
    fprintf(stderr, "%s is not written: %s\n", path, sinew_status_text((int)status));
    return EXIT_FAILURE;
}

int main(int count, char **arguments) {
    if (count < 3) return fprintf(stderr, "usage: loop ROBOT_DIR BASELINE [SAVE] < samples\n"), 2;
    if (sinew_abi_version() != SINEW_ABI_VERSION) return fprintf(stderr, "another libsinew\n"), 2;

    /* Construction. */
    char why[1024] = "";
    sinew_robot *robot = NULL;
    sinew_offsets *offsets = NULL;
    sinew_status status = sinew_robot_open(arguments[1], &robot, why, sizeof why);
    if (status != SINEW_STATUS_OK) return fprintf(stderr, "%s\n", why), EXIT_FAILURE;
    char *baseline = text_of(arguments[2]);
    if (baseline == NULL) {
        sinew_robot_free(robot);
        return perror(arguments[2]), EXIT_FAILURE;
    }
    status = sinew_offsets_new(robot, baseline, NULL, &offsets, why, sizeof why);
    free(baseline);
    const size_t joints = sinew_robot_joints(robot);
    if (status != SINEW_STATUS_OK || joints > MOST_JOINTS) {
        fprintf(stderr, "%s\n", status != SINEW_STATUS_OK ? why : "too many joints");
        sinew_offsets_free(offsets);
        sinew_robot_free(robot);
        return EXIT_FAILURE;
    }

    double q[MOST_JOINTS], theta[MOST_JOINTS];
    double t_s = 0.0, first_s = NAN, before_s = NAN, print_s = PRINT_S;
    int answer = EXIT_SUCCESS;
    while (sample_of(stdin, joints, &t_s, q, theta)) {
        if (isnan(first_s)) first_s = before_s = t_s;

        /* Sample. An unusable sample is rejected with a reason and leaves the estimate unchanged. */
        sinew_stepped became = SINEW_STEPPED_ACCEPTED;
        status = sinew_offsets_step(offsets, t_s - before_s, q, theta, NULL, NAN, joints, &became);

        /* Work. A recording is faster than a robot, so the loop waits for the solution here. On a robot it must not wait:
         * call sinew_offsets_start_worker once instead, before the loop. */
        if (status == SINEW_STATUS_OK && became == SINEW_STEPPED_BLOCK) status = sinew_offsets_work(offsets);

        /* Output. */
        if (status != SINEW_STATUS_REJECTED && status != SINEW_STATUS_OK) {
            fprintf(stderr, "at %g s: %s\n", t_s, sinew_status_text((int)status));
            answer = EXIT_FAILURE;
            break;
        }
        before_s = t_s;
        if (t_s - first_s >= print_s) {
            print_s += PRINT_S;
            print(robot, offsets, t_s - first_s);
        }
    }
    if (answer == EXIT_SUCCESS && (isnan(first_s) || !feof(stdin))) {
        fprintf(stderr, isnan(first_s) ? "no samples\n" : "after %g s: no number where one is due\n", t_s);
        answer = EXIT_FAILURE;
    }
    /* After an error nothing is saved, and an existing file is kept. */
    if (answer == EXIT_SUCCESS && count > 3) answer = save(offsets, t_s, arguments[3]);
    sinew_offsets_free(offsets);
    sinew_robot_free(robot);
    return answer;
}
