"""The numbers that decide: what is claimed, refused or reported, and which of two answers is kept.

Each stands here once, under the question that it answers: what it means, then its source. Whatever
in ``correction`` and ``discrepancy`` decides compares with one of these or with what follows from
one; a test counts them and looks for others. Where a search begins, how much it tries, priors,
tolerances of the numerics and what a picture shows are no judgement, and stand where they are used.
"""

from math import log

# Odds and probabilities

# ln of the odds, 100 to 1: what acts beyond, what can be distinguished, a manoeuvre that decides
# source: "decisive" of Jeffreys, Theory of Probability, 1961, appendix B
CERTAIN = log(100)
# of the score, −2 ln of a probability, odds of 10 to 1: closer structures meet again on whole runs
# source: "strong" of Jeffreys; nothing is claimed by it
CLOSE = 2 * log(10)
# of the score, or of χ² of independent samples: a difference that counts, and nearer is a rival
# source: "very strong", odds of 150 to 1: Kass & Raftery, JASA 90, 1995
SIGNIFICANT = 10.0
# posterior probability of what is named, or claimed beside a class; a class with the rest is said
# source: convention: of twenty names one is expected to be wrong
PROBABLE = 0.95
# posterior probability: rather so than not
# source: definition
LIKELY = 0.5
# probability that any recording is named as an outlier of a fleet in which all agree
# source: convention: one fleet of a thousand
CHANCE = 1e-3
# of ln evidence: a class that is predicted to stay so far behind what was fitted is not fitted
# source: three times what SIGNIFICANT asks for, for the linear problem is rough
HOPELESS = 30.0
# times the median power: a line of the missing force
# source: 1 of 4000 lines of white noise has as much, exp(−12 ln 2)
PEAK_LEAST = 12.0

# Deviations

# standard deviations: the strength of a cause, a place, an energy, a signal against its noise
# source: convention: two sided, 0.3 % of normal errors are further off
OUTSTANDING = 3.0
# standard deviations where the largest of many is looked at: mean squares, delays, means of a bin
# source: 0.006 % of normal errors are further off, so that 1 of 150 searches among 100 errs
SURE = 4.0
# standard deviations, one sided: expected evidence, and predictions by rates against forces
# source: convention: 2.3 % of normal errors are beyond
MARGIN = 2.0

# How well the noise is known

# χ² per sample: what leaves no more is at the noise
# source: judgement: how well smoothing knows a variance
NEAR_NOISE = 1.1
# χ² per sample: what leaves more is not explained
# source: judgement: more than the half of it is not noise
UNEXPLAINED = 2.0
# times a standard deviation of noise: measured against stated, and left over against expected
# source: judgement
NOISE_FACTOR = 2.0
# independent pieces of what a model lacks
# source: judgement: a cause takes about half of it; 20, 25 and 30 tried on EMPS and roll decays
PIECES = 20.0
# samples of memory: no force of a machine decorrelates as fast, so it is noise of an input
# source: judgement, seen on one seed of each kind of studies/outside
FAST = 3.0
# excess kurtosis: innovations of a sensor that jumps or freezes, a residual with impacts in it
# source: judgement: 0 of normal noise, 3 of double exponential; seen on studies/outside
BURSTS = 10.0

# Parts of a whole

# of a force, a gain, an energy, a mismatch: less is the error of the numerics
# source: half of ACCURACY: what integration and interpolation err by
NEGLIGIBLE = 1e-3
# of a whole: less is not worth a word
# source: judgement: what an engineer rounds away
NOTABLE = 0.05
# of a mismatch or a misfit that what explains it may leave; of a value or evidence that differs
# source: judgement: nine tenths explained; real recordings with right names leave 4 % at most
SMALL = 0.1
# of a force, a misfit or a spread: from here on it is a large part
# source: judgement, seen on EMPS, the roll decay and two seeds of each kind of studies/outside
LARGE = 1 / 3
# of what is left or moves: the main part, which a cause takes, a memory explains, a strength keeps
# source: judgement: the practical size of one cause among what is left
MOST = 0.5
# relative, of a fitted value: a part of every deviation
# source: judgement: fixed steps, held inputs and smoothed friction
ACCURACY = 2e-3
# of 1 − ρ² of two effects: less, and they are the same
# source: two ways to state one force differ by as much as windows are discrete
SAME = 1e-5
# times: two faults, or a fault and a cause, whose misfits are closer cannot be distinguished
# source: judgement: squares, so that errors differ by 1.7
ALIKE = 3.0
# times the spread of the other runs: this one only seems to be a repeat
# source: judgement
STRANGE = 5.0

# What is no oversight

# of all squared forces, that no ordinary cause takes: more, and the recording is suspected
# source: 184 simulated recordings with and without missing physics stay below
SUSPECT = 2e-3
# from 1: a gain that is further off is a wrong unit or sign
# source: convention: usual units are further apart than 1.5
GAIN_REACH = 0.5
# times a number of the model: a mass or parameter that is further off is no slip
# source: judgement, seen on a pole of the cart–pole
SLIP_MOST = 2.0
# s/s: a clock that is better does not matter, one that is worse is no clock
# source: quartz errs by 2e-5 to 5e-5
DRIFT_LEAST = 5e-5
# s/s: the same, at most
# source: judgement: beyond, a column is another signal
DRIFT_MOST = 0.05
# samples: a smaller delay is a matter of how a signal was held between samples
# source: judgement: half of what holding shifts a signal by
DELAY_LEAST = 0.25
# times the measured range: a simulation that is further away has run away
# source: judgement: no recording scales so far
RUNAWAY = 100.0

# How long, and how often

# samples that recordings have together, to show anything
# source: judgement: a mean square is then known to 14 %
SAMPLES_TELL = 100
# of the slowest motion: how long recordings are together, to show anything
# source: judgement: what comes back once can be compared with itself
PERIODS_LEAST = 2.0
# periods, and times OUTSTANDING deviations of noise: what a recording that decides nothing lacks
# source: judgement
AMPLE = 10.0
# windows over all recordings, at their longest
# source: six are fitted and three held, which then differ among themselves
WINDOWS_LEAST = 9
# times an error of the initial state may grow beyond what it does where no force acts
# source: judgement: the fit of a window in which it grows by more has many minima
GROWN = 10.0
# windows, runs or recordings whose spread among themselves says something
# source: two have one difference only
FEWEST = 3
# samples or changes that show a rate, or a level of noise
# source: judgement: a deviation is then known to 16 %
FEW = 20
# samples of a mean or of a period, lines of a spectrum
# source: judgement: a mean is then known to a third of the deviation
HANDFUL = 8

# First checks and pictures in words

# of the largest power density of an input: here it drives the machine
# source: judgement: the second side lobe of a Hann window has 7e-5
EXCITED = 1e-4
# of the largest speed: what stands still is slower
# source: judgement
SLOW = 0.01
# deviations of the smoothed motion by which runs of one manoeuvre may differ at their start
# source: judgement: splines are up to ten times worse at their ends
START_DEVIATIONS = 15.0
# of the largest stretch: a force that begins earlier is there from the start
# source: a cubic law is quiet up to 0.37 of its stretch, by the limit NOTABLE
BEYOND_LEAST = 0.4

# Samples that a sensor got wrong

# of the samples, at the very extreme: saturated
# source: judgement: a sine is 1 % of the time within 2.5e-4 of its range from an end
CLIPPED = 0.01
# times as many samples as at the level beside the extreme
# source: judgement: the crest of a coarse signal is populated, but evenly
CREST = 5
# of the RMS step: how fast a saturated signal runs into its limit
# source: judgement: a motion that comes to rest slows down first
ENTRY = 0.2
# times what nine of ten samples deviate from the cubic through their neighbours
# source: judgement: 20 deviations of normal noise
SPIKE = 12.0
# how closely the neighbours of a spike show that it alone is wrong
# source: judgement: of the pattern −2/3, 1, −2/3; a kink or a step has another
SPIKE_PATTERN = 0.2
