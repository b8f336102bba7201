/* Lamps and suns whose direct light is in a bake's harmonics, as far as these tell how much of each is seen. */
#ifndef LMB_TOOLS_LAMPS_SEEN_H
#define LMB_TOOLS_LAMPS_SEEN_H

#include <lambent/emitters.h>
#include <lambent/key_light.h>

enum { LAMPS_MOST = 8 };

typedef struct lamps_seen {
    bool present; /* the level has some, seen from here or not */
    uint32_t count;
    lmb_key_light light[LAMPS_MOST]; /* the strongest first */
    float visibility[LAMPS_MOST];
} lamps_seen;

/* The strongest at a position, in front of a plane (`normal` NULL: all around). Each is taken out of `*radiance`, the
 * harmonics there, before the next is looked for in them. */
void lamps_take(const lmb_emitters *emitters, lmb_vec3 position, const lmb_vec3 *normal, lmb_sh3_rgb *radiance,
                lamps_seen *lamps);

#endif
