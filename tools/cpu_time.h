/* Processor time, which what else the machine does leaves alone. */
#ifndef LMB_TOOLS_CPU_TIME_H
#define LMB_TOOLS_CPU_TIME_H

/* Seconds that the calling thread has used. */
double cpu_time_of_thread(void);

/* Seconds that all threads of the program have used. */
double cpu_time_of_process(void);

#endif
