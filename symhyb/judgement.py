"""The numbers that decide: what is claimed, refused or told, and which of two answers is kept.

Each stands here once, under the question that it answers: what it means, then its source. Whatever
in ``correction`` and ``discrepancy`` decides compares with one of these or with what follows from
one; a test counts them and looks for others. Where a search begins, how much it tries, priors,
tolerances of the numerics and what a picture shows are no judgement, and stand where they are used.
"""

# Odds and probabilities

# ln of the odds, 100 to 1: what acts beyond, and what can be distinguished
# source: "decisive" of Jeffreys, Theory of Probability, 1961, appendix B
CERTAIN = 4.6
# to 1: a manoeuvre that is expected to reach these odds decides
# source: the same, in the other scale
ODDS = 100.0
# of the score, −2 ln of a probability, odds of 10 to 1: closer structures meet again on whole runs
# source: "strong" of Jeffreys; nothing is claimed by it
CLOSE = 4.6
# of the score, or of χ² of independent samples: a difference that counts, and nearer is a rival
# source: "very strong", odds of 150 to 1: Kass & Raftery, JASA 90, 1995
SIGNIFICANT = 10.0
# posterior probability of what is named, or claimed beside a class; a class with the rest is told
# source: convention: of twenty names one is expected to be wrong
PROBABLE = 0.95
# posterior probability: rather so than not
# source: definition
LIKELY = 0.5
# probability that any recording is named as an outlier of a fleet in which all agree
# source: convention: one fleet of a thousand
CHANCE = 1e-3

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
# source: judgement: smoothing errs by some per cent of a variance; nulls of the bench stay below
NEAR_NOISE = 1.1
# χ² per sample: what leaves more is not explained
# source: judgement: twice the variance, seen on the real recordings of the studies
UNEXPLAINED = 2.0
# times a standard deviation of noise: measured against stated, and left over against expected
# source: judgement: the factor that data sheets are off by
NOISE_FACTOR = 2.0
# independent pieces of what a model lacks
# source: judgement: a cause takes about half of it; 20, 25 and 30 tried on EMPS and roll decays
PIECES = 20.0
# samples of memory: no force of a machine forgets as fast, so it is noise of an input
# source: judgement, seen on one seed of each kind of studies/outside
FAST = 3.0
# excess kurtosis of innovations: a sensor that jumps or freezes
# source: judgement: 0 of normal noise, 3 of double exponential; seen on studies/outside
BURSTS = 10.0

# Parts of a whole

# of a force, a gain, an energy, a mismatch: less is the error of the numerics
# source: integration and interpolation err by up to ACCURACY where noise hides it
NEGLIGIBLE = 1e-3
# of a whole: less is not worth a word, or a trial
# source: judgement: what an engineer rounds away
NOTABLE = 0.05
# of a mismatch or a misfit that what explains it may leave; of a value that differs
# source: judgement: nine tenths explained; real recordings with right names leave 4 % at most
SMALL = 0.1
# of a force, a misfit or a spread: from here on it is a large part
# source: judgement, seen on EMPS, the roll decay and two seeds of each kind of studies/outside
LARGE = 1 / 3
# of what is left or moves: the main part, which a cause takes, a memory explains, a strength keeps
# source: judgement: the practical size of one cause among what is left
MOST = 0.5
# relative, of a fitted value: a part of every deviation
# source: fixed steps, held inputs and smoothed friction, measured on simulated machines
ACCURACY = 2e-3
# of 1 − ρ² of two effects: less, and they are the same
# source: two ways to state one force differ by as much as windows are discrete
SAME = 1e-5
# times: two faults, or a fault and a cause, whose misfits are closer cannot be distinguished
# source: judgement, seen on faults put into three simulated machines
ALIKE = 3.0
# times the spread of the other runs: this one only seems to be a repeat
# source: judgement, seen on simulated repeats
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
# periods, and times OUTSTANDING deviations of noise: what a recording that tells nothing lacks
# source: judgement
AMPLE = 10.0
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
# source: judgement: a Hann window leaks less
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
