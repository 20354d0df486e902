/* controller [LCM-URL]: example of a controller in C that needs LCM and the generated message type only.
 *
 * At 40 Hz it takes the newest message of CARTVO_ODOMETRY, checks it, extrapolates its motion to now, and
 * prints a yaw damping command. Once the last usable message is older than its time to live, the command goes
 * to zero within 0.5 s. It does in C most of what a controller in C++ gets from cartvo_client, which also
 * finds two daemons on one channel. Build it:
 *
 *   lcm-gen --c /usr/share/cartvo/messages/odometry_t.lcm
 *   cc -std=c11 -D_POSIX_C_SOURCE=200809L -I. controller.c cartvo_odometry_t.c -o controller -llcm -lm
 */
#include <cartvo_odometry_t.h>
#include <inttypes.h>
#include <lcm/lcm.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#define PERIOD_NS 25000000          /* 40 Hz */
#define RAMP_S 0.5                  /* authority from 1 to 0, and from 0 to 1 */
#define LONGEST_CYCLE_S 0.1         /* raises the authority by no more, so that a stall is no jump */
#define MAX_AGE_US 1000000          /* the controller's own limit, whatever the time to live */
#define MAX_FUTURE_US 10000         /* difference between the clocks of two computers */
#define MAX_MESSAGES_PER_CYCLE 1000 /* a flood does not keep the control loop */
#define MAX_YAW_RATE_BOUND 0.035    /* rad/s: 2 deg/s, the controller's own alert limit */
#define SILENCE_US 1000000          /* then the daemon's clock may have been set back */
#define ACCELERATION 2.0            /* m/s^2, standard deviation that a constant velocity does not know */
#define YAW_GAIN 4.0                /* rad of the steering wheel per rad/s */
#define DEGREES 57.29577951308232

typedef struct {
  cartvo_odometry_t newest; /* arrays of fixed size only: a copy is complete */
  cartvo_odometry_t usable; /* the last usable one */
  bool has_newest, has_usable;
  int64_t lost, ignored, epoch;
  int64_t usable_epoch; /* of the last usable one: poses of two epochs are not related */
  int64_t reception_us; /* of the newest, by a clock that is never set */
} odometry;

/* The motion of a message at a later instant. */
typedef struct {
  double x, y, yaw;       /* in the world: m, rad */
  double speed, yaw_rate; /* body axes: m/s, rad/s */
  double speed_stddev;    /* m/s */
} motion;

static int64_t microseconds(clockid_t clock) {
  struct timespec now;
  clock_gettime(clock, &now);
  return (int64_t)now.tv_sec * 1000000 + now.tv_nsec / 1000;
}

/* NaN is not within any limit. */
static bool all_within(const double* values, int count, double limit) {
  for (int i = 0; i < count; ++i) {
    if (!(fabs(values[i]) <= limit)) return false;
  }
  return true;
}

static bool is_covariance(const double* matrix) {
  for (int i = 0; i < 6; ++i) {
    if (!(matrix[7 * i] >= 0.0)) return false;
  }
  return all_within(matrix, 36, 1e12);
}

/* Errors exceed these bounds with a probability of at most 1e-4 a message. */
static bool are_bounds(const double* bounds) {
  return all_within(bounds, 3, 1e12) && bounds[0] >= 0.0 && bounds[1] >= 0.0 && bounds[2] >= 0.0;
}

static bool is_usable(const cartvo_odometry_t* m, int64_t now) {
  const double* q = m->orientation_world_body;
  if (m->status != CARTVO_ODOMETRY_T_VALID) return false;
  if ((m->reasons & ~CARTVO_ODOMETRY_T_REASON_ZERO_VELOCITY) != 0) return false;
  if (!all_within(m->velocity_body, 3, 100.0) || !all_within(m->angular_velocity_body, 3, 10.0)) return false;
  if (!all_within(m->position_world_body, 3, 1e7)) return false;
  if (!(fabs(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] - 1.0) <= 1e-3)) return false;
  if (!is_covariance(m->pose_covariance_body) || !is_covariance(m->twist_covariance_body)) return false;
  if (m->quality <= 0 || !are_bounds(m->velocity_bound) || !are_bounds(m->angular_rate_bound)) return false;
  if (m->angular_rate_bound[2] > MAX_YAW_RATE_BOUND) return false;
  if (m->utime < 0 || m->time_to_live_us <= 0) return false; /* then the next line cannot overflow */
  const int64_t age = now - m->utime;
  return age >= -MAX_FUTURE_US && age <= m->time_to_live_us && age <= MAX_AGE_US;
}

/* Keeps the newest message. UDP repeats and reorders: a lower sequence that was published later is a
 * restarted daemon, another one is late. */
static void on_message(const lcm_recv_buf_t* buffer, const char* channel, const cartvo_odometry_t* m,
                       void* user) {
  odometry* o = user;
  const int64_t now = microseconds(CLOCK_REALTIME);
  (void)buffer;
  (void)channel;
  const bool has_restarted = o->has_newest && m->sequence <= o->newest.sequence;
  const int64_t reception_us = microseconds(CLOCK_MONOTONIC);
  const bool is_silent = reception_us - o->reception_us > SILENCE_US;
  if (has_restarted && m->publication_utime <= o->newest.publication_utime && !is_silent) {
    ++o->ignored;
    return;
  }
  if (o->has_newest && (has_restarted || m->reset_counter != o->newest.reset_counter)) ++o->epoch;
  if (o->has_newest && !has_restarted && o->newest.sequence >= 0)
    o->lost += m->sequence - o->newest.sequence - 1;
  if (has_restarted) o->lost = 0;
  o->newest = *m;
  o->reception_us = reception_us;
  o->has_newest = true;

  /* A frozen camera, or cameras that do not fit together: the messages before may be wrong too. */
  const int32_t against =
      CARTVO_ODOMETRY_T_REASON_REPEATED_PICTURE | CARTVO_ODOMETRY_T_REASON_WRONG_STEREO_GEOMETRY;
  if (m->status != CARTVO_ODOMETRY_T_VALID && (m->reasons & against) != 0) o->has_usable = false;
  if (!is_usable(m, now)) return;
  if (o->has_usable && is_usable(&o->usable, now) && m->utime < o->usable.utime) return;
  o->usable = *m;
  o->usable_epoch = o->epoch;
  o->has_usable = true;
}

/* Constant speed and yaw rate on a plane; cartvo_client does it in three dimensions. */
static motion extrapolate(const cartvo_odometry_t* m, int64_t now) {
  const double dt = now > m->utime ? 1e-6 * (double)(now - m->utime) : 0.0;
  const double* q = m->orientation_world_body;
  const double yaw = atan2(2.0 * (q[0] * q[3] + q[1] * q[2]), 1.0 - 2.0 * (q[2] * q[2] + q[3] * q[3]));
  const double turn = m->angular_velocity_body[2] * dt;
  const double path = m->velocity_body[0] * dt;
  const double chord = fabs(turn) > 1e-6 ? path * sin(0.5 * turn) / (0.5 * turn) : path;
  motion now_motion;
  now_motion.x = m->position_world_body[0] + chord * cos(yaw + 0.5 * turn);
  now_motion.y = m->position_world_body[1] + chord * sin(yaw + 0.5 * turn);
  now_motion.yaw = yaw + turn;
  now_motion.speed = m->velocity_body[0];
  now_motion.yaw_rate = m->angular_velocity_body[2];
  now_motion.speed_stddev = sqrt(m->twist_covariance_body[0] + ACCELERATION * dt * ACCELERATION * dt);
  return now_motion;
}

/* b - a */
static double seconds_between(const struct timespec* a, const struct timespec* b) {
  return (double)(b->tv_sec - a->tv_sec) + 1e-9 * (double)(b->tv_nsec - a->tv_nsec);
}

/* After a stall the next cycle begins now: missed ones are not made up for. */
static void sleep_until_next_cycle(struct timespec* next) {
  struct timespec now;
  next->tv_nsec += PERIOD_NS;
  if (next->tv_nsec >= 1000000000) {
    next->tv_nsec -= 1000000000;
    ++next->tv_sec;
  }
  clock_gettime(CLOCK_MONOTONIC, &now);
  if (seconds_between(next, &now) > 0.0) *next = now;
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, next, NULL);
}

/* The share of odometry in the command, `cycle_s` later: falls to 0 and rises to 1 in RAMP_S. */
static double next_authority(double authority, bool usable, double cycle_s) {
  if (usable) return fmin(authority + fmin(cycle_s, LONGEST_CYCLE_S) / RAMP_S, 1.0);
  return fmax(authority - cycle_s / RAMP_S, 0.0);
}

int main(int argument_count, char** arguments) {
  const char* url =
      argument_count > 1 ? arguments[1] : NULL;  // LCM_DEFAULT_URL, else udpm://239.255.76.67:7667
  lcm_t* lcm = lcm_create(url);
  if (lcm == NULL) {
    fprintf(stderr, "cannot open LCM at %s: check that a multicast route exists, see cartvod(8)\n",
            url == NULL ? "its default URL" : url);
    return 1;
  }
  setvbuf(stdout, NULL, _IOLBF, 0);
  odometry o;
  memset(&o, 0, sizeof o);
  cartvo_odometry_t_subscribe(lcm, "CARTVO_ODOMETRY", on_message, &o);

  double authority = 0.0;
  motion last = {0};
  struct timespec next, last_cycle, this_cycle;
  clock_gettime(CLOCK_MONOTONIC, &next);
  last_cycle = next;
  for (int cycle = 0;; ++cycle) {
    for (int i = 0; i < MAX_MESSAGES_PER_CYCLE && lcm_handle_timeout(lcm, 0) > 0; ++i) {
    }
    const int64_t now = microseconds(CLOCK_REALTIME);
    const bool usable = o.has_usable && is_usable(&o.usable, now);
    if (usable) last = extrapolate(&o.usable, now);
    clock_gettime(CLOCK_MONOTONIC, &this_cycle);
    authority = next_authority(authority, usable, seconds_between(&last_cycle, &this_cycle));
    last_cycle = this_cycle;
    const double command = -authority * YAW_GAIN * last.yaw_rate; /* rad, to be sent to the actuator */
    if (cycle % 8 == 0) {
      const char* state = usable            ? "measured"
                          : authority > 0.0 ? "ramping"
                          : o.has_usable    ? "safe"
                                            : "waiting";
      printf(
          "%-8s  authority %4.2f  command %+8.3f deg  speed %6.2f +- %4.2f m/s  at %.2f %.2f m  heading %.1f "
          "deg  "
          "lost %" PRId64 "  epoch %" PRId64 "\n",
          state, authority, command * DEGREES, last.speed, last.speed_stddev, last.x, last.y,
          last.yaw * DEGREES, o.lost, o.usable_epoch);
    }
    sleep_until_next_cycle(&next);
  }
}
