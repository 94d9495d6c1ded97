/* What Grbl's planner.c needs of the rest of Grbl, to compile it for a host computer: our own text,
   with the names that planner.c uses. See driver.c. */
#ifndef HOST_GRBL_H
#define HOST_GRBL_H
#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#define N_AXIS 3
#define X_AXIS 0
#define Y_AXIS 1
#define Z_AXIS 2
#define bit(n) (1 << (n))
#define min(a, b) (((a) < (b)) ? (a) : (b))
#define max(a, b) (((a) > (b)) ? (a) : (b))
#define SOME_LARGE_VALUE 1.0E+38
#define MINIMUM_JUNCTION_SPEED 0.0
#define MINIMUM_FEED_RATE 1.0

#include "planner.h"

typedef struct {
  float steps_per_mm[N_AXIS], max_rate[N_AXIS], acceleration[N_AXIS], junction_deviation;
} settings_t;
typedef struct {
  uint8_t r_override, f_override;
} system_t;
extern settings_t settings;
extern system_t sys;
extern int32_t sys_position[N_AXIS];

float convert_delta_vector_to_unit_vector(float *vector);
float limit_value_by_axis_maximum(float *max_value, float *unit_vec);
uint8_t get_direction_pin_mask(uint8_t axis);
void st_update_plan_block_parameters(void);
#endif
