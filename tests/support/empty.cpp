// Carries the precompiled header and the usage requirements that the tests share.
