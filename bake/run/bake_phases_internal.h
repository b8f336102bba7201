#ifndef LMB_BAKE_PHASES_INTERNAL_H
#define LMB_BAKE_PHASES_INTERNAL_H

#include <lambent/bake_phases.h>

/* Puts into the record what is known of the level's solved light, if there is any. */
void lmb_bake_record_surface(lmb_bake *bake);

#endif
