// Written by covering_array.py: 24 scenes, 216 pairs of policies, each at least once.
#pragma once

inline constexpr int covered_pairs = 216;

using Rows0 = TypeList<
    Row<NeoHookean, Free, Pic, CubicBSpline, Mls, double, Serial>,
    Row<StableNeoHookean, Free, Pic, CubicBSpline, Mls, double, Threads>,
    Row<FixedCorotated, Free, Tpic, QuadraticBSpline, Mls, float, Serial>,
    Row<StVenantKirchhoff, Free, Flip, CubicBSpline, Mls, double, Serial>,
    Row<FibreReinforced<>, Free, Flip, QuadraticBSpline, Mls, float, Serial>,
    Row<WeaklyCompressibleFluid, Free, Apic, LinearBSpline, WeightGradient, double, Threads>>;
using Rows1 = TypeList<
    Row<NeoHookean, Falls, Apic, QuadraticBSpline, Mls, double, Threads>,
    Row<StableNeoHookean, Falls, Tpic, QuadraticBSpline, Mls, float, Serial>,
    Row<FixedCorotated, Falls, Apic, LinearBSpline, WeightGradient, double, Threads>,
    Row<StVenantKirchhoff, Falls, Apic, CubicBSpline, WeightGradient, float, Threads>,
    Row<FibreReinforced<>, Falls, Tpic, QuadraticBSpline, Mls, double, Threads>,
    Row<WeaklyCompressibleFluid, Falls, Tpic, CubicBSpline, WeightGradient, float, Threads>>;
using Rows2 =
    TypeList<Row<NeoHookean, Hangs, Tpic, CubicBSpline, Mls, float, Threads>,
             Row<StableNeoHookean, Hangs, Apic, LinearBSpline, WeightGradient, float, Serial>,
             Row<FixedCorotated, Hangs, Flip, QuadraticBSpline, WeightGradient, double, Threads>,
             Row<StVenantKirchhoff, Hangs, Pic, LinearBSpline, WeightGradient, float, Serial>,
             Row<FibreReinforced<>, Hangs, Pic, LinearBSpline, WeightGradient, double, Serial>,
             Row<WeaklyCompressibleFluid, Hangs, Flip, QuadraticBSpline, Mls, double, Serial>>;
using Rows3 = TypeList<
    Row<NeoHookean, Relaxes, Flip, LinearBSpline, WeightGradient, float, Threads>,
    Row<StableNeoHookean, Relaxes, Flip, QuadraticBSpline, WeightGradient, double, Serial>,
    Row<FixedCorotated, Relaxes, Pic, CubicBSpline, Mls, float, Serial>,
    Row<StVenantKirchhoff, Relaxes, Tpic, QuadraticBSpline, WeightGradient, float, Serial>,
    Row<FibreReinforced<>, Relaxes, Apic, CubicBSpline, WeightGradient, float, Serial>,
    Row<WeaklyCompressibleFluid, Relaxes, Pic, QuadraticBSpline, WeightGradient, float, Serial>>;
