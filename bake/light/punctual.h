/* Point, spot and directional lights, chosen for a point (lmb_emitters_punctual). */
#ifndef LMB_PUNCTUAL_H
#define LMB_PUNCTUAL_H

#include <lambent/emitters.h>

typedef struct lmb_punctual lmb_punctual;

/* @return LMB_ERROR_MEMORY */
lmb_result lmb_punctual_create(const lmb_scene *scene, lmb_punctual **punctual);
void lmb_punctual_destroy(lmb_punctual *punctual);

/* How many there are. `skip_keys`: that are not key lights; so below. */
uint32_t lmb_punctual_count(const lmb_punctual *punctual, bool skip_keys);

bool lmb_punctual_are_soft(const lmb_punctual *punctual, bool skip_keys);
bool lmb_punctual_are_few(const lmb_punctual *punctual, bool skip_keys);

int lmb_punctual_choose(const lmb_punctual *punctual, const lmb_punctual_query *query, const float choice[2], int max,
                        lmb_punctual_sample sample[2 * LMB_PUNCTUAL_MAX]);

void lmb_punctual_again(const lmb_punctual *punctual, const lmb_punctual_query *query, lmb_punctual_sample *sample);

#endif
