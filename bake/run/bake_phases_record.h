/* What is put into the record of results that phases have found, or that were read from a file. */
#ifndef LMB_BAKE_PHASES_RECORD_H
#define LMB_BAKE_PHASES_RECORD_H

#include <lambent/bake_phases.h>

/* The level's solved light, if there is any. */
void lmb_bake_record_surface(lmb_bake *bake);

/* What levels the bake's probes have. */
void lmb_bake_record_levels(lmb_bake *bake);

#endif
