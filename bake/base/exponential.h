/* Repeatable exponentials: the same bits on every machine, which libm's have not. */
#ifndef LMB_EXPONENTIAL_H
#define LMB_EXPONENTIAL_H

/* e^x within 3e-16 of itself; 0 below -746, infinite above 710. */
double lmb_exp(double x);

/* The natural logarithm of finite x > 0, normal, within 3e-16 of itself or of 1. */
double lmb_log(double x);

/* x^y of x > 0, within 4e-16 (1 + |y log x|) of itself. */
static inline double lmb_pow(double x, double y)
{
    return lmb_exp(y * lmb_log(x));
}

#endif
