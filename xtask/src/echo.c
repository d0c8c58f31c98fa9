/* A plain echo pair on a CAN interface: what the kernel takes for a round trip, and nothing else.
 *
 * One process sends a frame of 8 bytes and blocks until the answer is there; the other one blocks,
 * and sends back what it gets. Prints the median of the round trips in nanoseconds.
 *
 *     echo INTERFACE ROUNDS
 */

#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { COMMAND = 0x101, ANSWER = 0x201 };

static int opened(const char *interface, canid_t id)
{
    int line = socket(PF_CAN, SOCK_RAW, CAN_RAW);
    struct sockaddr_can address = { .can_family = AF_CAN };
    struct can_filter filter = { .can_id = id, .can_mask = CAN_SFF_MASK };

    address.can_ifindex = (int)if_nametoindex(interface);
    if (line < 0 || address.can_ifindex == 0
        || setsockopt(line, SOL_CAN_RAW, CAN_RAW_FILTER, &filter, sizeof filter) != 0
        || bind(line, (struct sockaddr *)&address, sizeof address) != 0) {
        perror("echo");
        exit(1);
    }
    return line;
}

static int64_t now_ns(void)
{
    struct timespec now;

    clock_gettime(CLOCK_MONOTONIC, &now);
    return (int64_t)now.tv_sec * 1000000000 + now.tv_nsec;
}

static int by_size(const void *one, const void *other)
{
    int64_t a = *(const int64_t *)one, b = *(const int64_t *)other;

    return (a > b) - (a < b);
}

int main(int count, char **words)
{
    int rounds = count == 3 ? atoi(words[2]) : 0;
    int64_t *times = calloc((size_t)(rounds > 0 ? rounds : 1), sizeof *times);
    struct can_frame frame = { .can_id = COMMAND, .can_dlc = 8 };

    if (rounds <= 0 || times == NULL) {
        fputs("usage: echo INTERFACE ROUNDS\n", stderr);
        return 2;
    }
    /* Both are there before anything is sent. */
    int rig = opened(words[1], COMMAND), host = opened(words[1], ANSWER);
    pid_t child = fork();
    if (child == 0) {
        while (read(rig, &frame, sizeof frame) == (ssize_t)sizeof frame) {
            frame.can_id = ANSWER;
            if (write(rig, &frame, sizeof frame) < 0)
                return 1;
        }
        return 1;
    }
    for (int round = 0; round < rounds; round++) {
        struct can_frame answer;
        int64_t begin = now_ns();

        frame.data[0] = (uint8_t)round;
        if (write(host, &frame, sizeof frame) < 0
            || read(host, &answer, sizeof answer) != (ssize_t)sizeof answer) {
            perror("echo");
            kill(child, SIGKILL);
            return 1;
        }
        times[round] = now_ns() - begin;
    }
    kill(child, SIGKILL);
    waitpid(child, NULL, 0);
    qsort(times, (size_t)rounds, sizeof *times, by_size);
    printf("%lld\n", (long long)times[rounds / 2]);
    return 0;
}
