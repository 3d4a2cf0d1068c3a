//! The normal law's quantile, with the same bits on every machine.

/// The number that a standard normal variable exceeds with probability 1/2 - `q`, for
/// `q` in [0, 1/2): the quantile of 1/2 + q. Relative error below 1e-15.
///
/// Wichura 1988, "The percentage points of the normal distribution" (algorithm AS 241,
/// the finer of its two approximations). Taking the distance from 1/2 and not the
/// probability keeps all digits near the middle; `tail` = 1/2 - q does so at the end.
pub(crate) fn upper_quantile(q: f64, tail: f64) -> f64 {
    if q <= 0.425 {
        let r = 0.425 * 0.425 - q * q;
        return q * ratio(r, MIDDLE);
    }
    let r = libm::sqrt(-libm::log(tail));
    if r <= 5.0 {
        ratio(r - 1.6, SHOULDER)
    } else {
        ratio(r - 5.0, TAIL)
    }
}

/// The quantile of `p` in (0, 1).
pub(crate) fn quantile(p: f64) -> f64 {
    if p < 0.5 {
        -upper_quantile(0.5 - p, p)
    } else {
        upper_quantile(p - 0.5, 1.0 - p)
    }
}

/// A quotient of two polynomials of degree 7, coefficients from the constant up.
#[inline]
fn ratio(r: f64, [above, below]: [[f64; 8]; 2]) -> f64 {
    let value = |polynomial: [f64; 8]| polynomial.iter().rev().fold(0.0, |sum, c| sum * r + c);
    value(above) / value(below)
}

const MIDDLE: [[f64; 8]; 2] = [
    [
        3.387_132_872_796_366_5,
        1.331_416_678_917_843_8e2,
        1.971_590_950_306_551_3e3,
        1.373_169_376_550_946e4,
        4.592_195_393_154_987e4,
        6.726_577_092_700_87e4,
        3.343_057_558_358_813e4,
        2.509_080_928_730_122_7e3,
    ],
    [
        1.0,
        4.231_333_070_160_091e1,
        6.871_870_074_920_579e2,
        5.394_196_021_424_751e3,
        2.121_379_430_158_659_7e4,
        3.930_789_580_009_271e4,
        2.872_908_573_572_194_3e4,
        5.226_495_278_852_854e3,
    ],
];

const SHOULDER: [[f64; 8]; 2] = [
    [
        1.423_437_110_749_683_7,
        4.630_337_846_156_546,
        5.769_497_221_460_691,
        3.647_848_324_763_204_5,
        1.270_458_252_452_368_4,
        2.417_807_251_774_506e-1,
        2.272_384_498_926_918_4e-2,
        7.745_450_142_783_414e-4,
    ],
    [
        1.0,
        2.053_191_626_637_759,
        1.676_384_830_183_803_8,
        6.897_673_349_851e-1,
        1.481_039_764_274_800_8e-1,
        1.519_866_656_361_645_7e-2,
        5.475_938_084_995_345e-4,
        1.050_750_071_644_416_9e-9,
    ],
];

const TAIL: [[f64; 8]; 2] = [
    [
        6.657_904_643_501_104,
        5.463_784_911_164_114,
        1.784_826_539_917_291_3,
        2.965_605_718_285_048_7e-1,
        2.653_218_952_657_612_4e-2,
        1.242_660_947_388_078_4e-3,
        2.711_555_568_743_487_6e-5,
        2.010_334_399_292_288_1e-7,
    ],
    [
        1.0,
        5.998_322_065_558_88e-1,
        1.369_298_809_227_358e-1,
        1.487_536_129_085_061_5e-2,
        7.868_691_311_456_133e-4,
        1.846_318_317_510_054_8e-5,
        1.421_511_758_316_446e-7,
        2.044_263_103_389_939_7e-15,
    ],
];

#[cfg(test)]
mod tests {
    use super::*;

    /// The law of the quantile is the probability again, over all three pieces.
    #[test]
    fn inverts_the_normal_law() {
        let law = |x: f64| 0.5 * libm::erfc(-x / std::f64::consts::SQRT_2);
        for i in 1..2000 {
            let p = f64::from(i) / 2000.0;
            assert!((law(quantile(p)) - p).abs() < 1e-15, "{p}");
        }
        for exponent in 4..300 {
            let p = libm::exp2(f64::from(-exponent));
            let found = law(quantile(p));
            assert!((found / p - 1.0).abs() < 1e-12, "2^-{exponent}: {found:e}");
            assert!((quantile(p) + upper_quantile(0.5 - p, p)).abs() < 1e-12);
        }
    }
}
