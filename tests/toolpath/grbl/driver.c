/* Runs blocks through Grbl's planner and prints the seconds of each.

   Build, with a folder GRBL that has planner.c and planner.h of github.com/gnea/grbl at bfb67f0 alone:

     cc -O2 -include stdbool.h -I . -I GRBL -o grbl-planner driver.c GRBL/planner.c -lm

   where this folder's grbl.h takes the place of Grbl's own. Input: acceleration [mm/s^2] and rapid
   feed [mm/min] of each axis and junction deviation [mm], then one line for each block with its end
   x, y, z [mm] and its feed [mm/min], 0 for a traverse; the first block is the place of the start.

   The buffer is kept full, as while a program is streamed. The time of a block is that of the ramps
   which stepper.c, st_prep_buffer, makes of its entry, exit and nominal speed. */
#include <stdio.h>

#include "grbl.h"

settings_t settings;
system_t sys = {100, 100};
int32_t sys_position[N_AXIS];

float convert_delta_vector_to_unit_vector(float *vector) {
  float size = 0.0;
  for (int axis = 0; axis < N_AXIS; axis++) size += vector[axis] * vector[axis];
  size = sqrtf(size);
  for (int axis = 0; axis < N_AXIS; axis++) vector[axis] /= size;
  return size;
}

float limit_value_by_axis_maximum(float *most, float *way) {
  float found = SOME_LARGE_VALUE;
  for (int axis = 0; axis < N_AXIS; axis++)
    if (way[axis] != 0.0) found = min(found, fabsf(most[axis] / way[axis]));
  return found;
}

uint8_t get_direction_pin_mask(uint8_t axis) { return (uint8_t)(1 << axis); }
void st_update_plan_block_parameters(void) {}

static double run(plan_block_t *block) {
  double entry = block->entry_speed_sqr, leave = plan_get_exec_block_exit_speed_sqr();
  double nominal = plan_compute_profile_nominal_speed(block), a = block->acceleration;
  double length = block->millimeters, peak = 0.5 * (entry + leave) + a * length;
  peak = min(nominal * nominal, peak);
  peak = max(peak, max(entry, leave));
  double top = sqrt(peak), ramps = (2.0 * top - sqrt(entry) - sqrt(leave)) / a;
  double even = length - (2.0 * peak - entry - leave) / (2.0 * a);
  return 60.0 * (ramps + max(even, 0.0) / top);
}

int main(void) {
  double acceleration, rapid, deviation, x, y, z, feed;
  if (scanf("%lf %lf %lf", &acceleration, &rapid, &deviation) != 3) return 2;
  for (int axis = 0; axis < N_AXIS; axis++) {
    settings.steps_per_mm[axis] = 100000.0; /* fine: lengths are not to be rounded */
    settings.max_rate[axis] = (float)rapid;
    settings.acceleration[axis] = (float)(acceleration * 3600.0);
  }
  settings.junction_deviation = (float)deviation;
  plan_reset();
  if (scanf("%lf %lf %lf %lf", &x, &y, &z, &feed) != 4) return 2;
  double place[N_AXIS] = {x, y, z};
  for (int axis = 0; axis < N_AXIS; axis++)
    sys_position[axis] = lround(place[axis] * settings.steps_per_mm[axis]);
  plan_sync_position();
  while (scanf("%lf %lf %lf %lf", &x, &y, &z, &feed) == 4) {
    if (plan_check_full_buffer()) {
      printf("%.9g\n", run(plan_get_current_block()));
      plan_discard_current_block();
    }
    float target[N_AXIS] = {(float)x, (float)y, (float)z};
    plan_line_data_t data = {0};
    data.feed_rate = (float)feed;
    data.condition = feed > 0.0 ? 0 : PL_COND_FLAG_RAPID_MOTION;
    if (plan_buffer_line(target, &data) != PLAN_OK) return 3;
  }
  for (plan_block_t *block; (block = plan_get_current_block()) != NULL;) {
    printf("%.9g\n", run(block));
    plan_discard_current_block();
  }
  return 0;
}
