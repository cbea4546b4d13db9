/* The device's side of docs/udp-device.md: connects your own haptic device to osteomill by UDP datagrams.
 *
 *     cc -O2 -o udp_device udp_device.c -lm
 *     ./udp_device [PORT [LOG]]          PORT defaults to 47117; LOG gets a line per millisecond
 *     osteomill live --device udp:127.0.0.1:47117
 *
 * Replace describe(), read_handle() and drive_motors(), here or in a file that defines OWN_DEVICE and includes this one
 * (as chai3d_bridge.cpp does). The example versions lower and lift the handle by 4 mm every four seconds, and drive no
 * motors. The rest is the protocol: send states while wrenches arrive, never drive an old wrench, never change it faster
 * than a hand can bear. For Linux on little-endian machines, because the datagrams are little-endian. */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE /* ppoll */
#endif
#include <arpa/inet.h>
#include <errno.h>
#include <math.h>
#include <netinet/in.h>
#include <poll.h>
#include <sched.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>

enum { REQUEST = 1, REPLY = 2, STATE = 3, WRENCH = 4 };

struct head {
  char magic[4];
  uint16_t version, kind;
  uint32_t sequence, is_busy;
};
struct reply {
  struct head head;
  char name[64];
  uint32_t sensed, driven;
  double max_force_N, max_torque_Nmm;
};
struct state {
  struct head head;
  double position_mm[3], orientation_wxyz[4];
  uint32_t buttons, not_driven;
};
struct wrench {
  struct head head;
  double force_N[3], torque_Nmm[3];
};

static const double PERIOD_S = 1e-3;
static const double LAPSE_S = 5e-3;         /* an older wrench is zero */
static const double CONVERSATION_S = 0.1;   /* no states are sent to a partner silent for longer */
static const double FORCE_RATE_N_S = 4000;  /* fastest change that a hand can bear */
static const double TORQUE_RATE_NMM_S = 1e5;

static volatile sig_atomic_t ending;
static void end(int signal) {
  (void)signal;
  ending = 1;
}

static double now_s(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static struct head head_of(uint16_t kind, uint32_t sequence) {
  struct head head = {{'O', 'M', 'I', 'L'}, 1, kind, sequence, 0};
  return head;
}

#ifdef OWN_DEVICE
static void describe(struct reply *reply);
static int read_handle(double time_s, struct state *state);
static void drive_motors(const double force_N[3], const double torque_Nmm[3]);
#else
/* Replace: name and capabilities of your device. */
static void describe(struct reply *reply) {
  strcpy(reply->name, "example device");
  reply->sensed = reply->driven = 6;
  reply->max_force_N = 10;
  reply->max_torque_Nmm = 200;
}

/* Replace: position of the handle, in mm from the middle of its workspace; x to the operator's right, y up, z towards
 * them. Returns 0 if there is no new measurement. */
static int read_handle(double time_s, struct state *state) {
  const double pi = 3.14159265358979;
  state->position_mm[1] = 2 * cos(0.5 * pi * time_s) - 2;
  state->orientation_wxyz[0] = 1;
  state->buttons = 1;    /* 1: spindle, 2: clutch */
  state->not_driven = 0; /* 1: not calibrated, 2: force is off */
  return 1;
}

/* Replace: drive force and torque as they act on the hand, about the handle's origin, along the same axes. */
static void drive_motors(const double force_N[3], const double torque_Nmm[3]) {
  (void)force_N;
  (void)torque_Nmm;
}
#endif

static void approach(double sent[3], const double wanted[3], double most) {
  double way[3], length = 0;
  for (int n = 0; n < 3; ++n) {
    way[n] = wanted[n] - sent[n];
    length += way[n] * way[n];
  }
  length = sqrt(length);
  for (int n = 0; n < 3; ++n) sent[n] += length > most ? most / length * way[n] : way[n];
}

static int is_finite(const struct wrench *wrench) {
  for (int n = 0; n < 3; ++n)
    if (!isfinite(wrench->force_N[n]) || !isfinite(wrench->torque_Nmm[n])) return 0;
  return 1;
}

static int is_same(const struct sockaddr_in *a, const struct sockaddr_in *b) {
  return a->sin_port == b->sin_port && a->sin_addr.s_addr == b->sin_addr.s_addr;
}

int main(int count, char **words) {
  const int port = count > 1 ? atoi(words[1]) : 47117;
  FILE *log = count > 2 ? fopen(words[2], "w") : NULL;
  struct sockaddr_in here;
  memset(&here, 0, sizeof here);
  here.sin_family = AF_INET;
  here.sin_port = htons((uint16_t)port);
  here.sin_addr.s_addr = htonl(INADDR_LOOPBACK); /* INADDR_ANY if osteomill runs on another machine */
  const int to_all = socket(AF_INET, SOCK_DGRAM, 0);
  if (bind(to_all, (struct sockaddr *)&here, sizeof here) != 0) {
    fprintf(stderr, "udp_device: port %d: %s\n", port, strerror(errno));
    return 1;
  }
  /* Real-time priority, if the system allows it. */
  struct sched_param priority;
  memset(&priority, 0, sizeof priority);
  priority.sched_priority = 30;
  sched_setscheduler(0, SCHED_FIFO, &priority);
  signal(SIGINT, end);
  signal(SIGTERM, end);

  struct reply reply;
  memset(&reply, 0, sizeof reply);
  describe(&reply);

  struct sockaddr_in partner;
  struct wrench asked;
  memset(&partner, 0, sizeof partner);
  memset(&asked, 0, sizeof asked);
  double sent_N[3] = {0}, sent_Nmm[3] = {0}, heard_s = -1e9, started_s = 0;
  uint32_t states = 0;
  const double begun_s = now_s();
  for (double next_s = begun_s; !ending; next_s += PERIOD_S) {
    /* Receive until the next millisecond. */
    for (double left_s; (left_s = next_s - now_s()) > 0;) {
      struct pollfd wanted = {to_all, POLLIN, 0};
      const struct timespec wait = {0, (long)(1e9 * left_s)};
      if (ppoll(&wanted, 1, &wait, NULL) <= 0) continue;
      char bytes[256];
      struct sockaddr_in from;
      socklen_t from_length = sizeof from;
      const ssize_t length = recvfrom(to_all, bytes, sizeof bytes, 0, (struct sockaddr *)&from, &from_length);
      struct head head;
      if (length < (ssize_t)sizeof head) continue;
      memcpy(&head, bytes, sizeof head);
      if (memcmp(head.magic, "OMIL", 4) != 0 || head.version != 1) continue;
      if (head.kind == REQUEST) {
        reply.head = head_of(REPLY, head.sequence);
        reply.head.is_busy = next_s - heard_s < CONVERSATION_S && !is_same(&from, &partner);
        sendto(to_all, &reply, sizeof reply, 0, (struct sockaddr *)&from, from_length);
      } else if (head.kind == WRENCH && length == sizeof asked) {
        struct wrench wrench;
        memcpy(&wrench, bytes, sizeof wrench);
        const int talking = next_s - heard_s < CONVERSATION_S;
        /* Ignore other partners, and datagrams that arrive out of order. */
        if (talking && (!is_same(&from, &partner) || (int32_t)(head.sequence - asked.head.sequence) <= 0)) continue;
        if (!is_finite(&wrench)) continue;
        if (!talking) started_s = next_s;
        partner = from;
        asked = wrench;
        heard_s = now_s();
      }
    }
    if (now_s() - next_s > 10 * PERIOD_S) next_s = now_s(); /* stalled: skip the missed ticks */
    const double zero[3] = {0};
    const int old = now_s() - heard_s > LAPSE_S;
    approach(sent_N, old ? zero : asked.force_N, FORCE_RATE_N_S * PERIOD_S);
    approach(sent_Nmm, old ? zero : asked.torque_Nmm, TORQUE_RATE_NMM_S * PERIOD_S);
    drive_motors(sent_N, sent_Nmm);
    if (log) {
      fprintf(log, "%.6f %.6f %g %g %g %g %g %g\n", now_s(), heard_s, sent_N[0], sent_N[1], sent_N[2], sent_Nmm[0],
              sent_Nmm[1], sent_Nmm[2]);
      fflush(log);
    }
    if (now_s() - heard_s < CONVERSATION_S) {
      struct state state;
      memset(&state, 0, sizeof state);
      state.head = head_of(STATE, states + 1);
      if (!read_handle(next_s - started_s, &state)) continue;
      ++states;
      sendto(to_all, &state, sizeof state, 0, (struct sockaddr *)&partner, sizeof partner);
    }
  }
  const double zero[3] = {0};
  drive_motors(zero, zero);
  return 0;
}
