/* The rows of the table. A new model is a file of its own, a line here and one in model.c. */
#ifndef LMB_MODELS_H
#define LMB_MODELS_H

#include <lambent/model.h>

extern const lmb_model lmb_model_irradz_hhd;
extern const lmb_model lmb_model_hlsh;
extern const lmb_model lmb_model_sh3;
extern const lmb_model lmb_model_hhd_closed_gram;
extern const lmb_model lmb_model_sh2;
extern const lmb_model lmb_model_scalar;

#endif
