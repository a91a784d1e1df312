//! Published models of single drives: Rhoban/bam, bam/params, commit 1b5a1cee2e6dcd2ab8c12b013f1e05482b16cb96, Apache-2.0;
//! M. Duclusaud, G. Passault, V. Padois, O. Ly, "Extended friction models for the physics simulation of servo actuators", IEEE
//! ICRA 2025. At the joint, SI. Identified on a pendulum: m1 Coulomb and viscous; m2 with Stribeck's; m4 with the load's;
//! m6 with the direction and the square of the load.

use super::Drive;

const NONE: Drive = Drive {
    name: "",
    torque: 0.0,
    armature: 0.0,
    base: 0.0,
    viscous: 0.0,
    stribeck: 0.0,
    stribeck_speed: 1.0,
    alpha: 1.0,
    load: 0.0,
    load_stribeck: 0.0,
    motor: 0.0,
    external: 0.0,
    motor_stribeck: 0.0,
    external_stribeck: 0.0,
    motor_square: 0.0,
    external_square: 0.0,
};

pub(super) const DRIVES: [Drive; 13] = [
    Drive {
        name: "erob80_100 m1",
        torque: 20.0,
        armature: 0.958_953_391_716_304_1,
        base: 5.610_965_892_410_754,
        viscous: 8.392_324_354_671_375,
        ..NONE
    },
    Drive {
        name: "erob80_100 m2",
        torque: 20.0,
        armature: 0.973_201_766_756_338_2,
        base: 1.4462862541212224e-10,
        viscous: 9.570_659_122_263_434,
        stribeck: 5.455_188_967_669_691,
        stribeck_speed: 2.079_758_511_184_917,
        alpha: 2.999_996_730_586_33,
        ..NONE
    },
    Drive {
        name: "erob80_100 m4",
        torque: 20.0,
        armature: 0.946_980_294_129_391_3,
        base: 0.000_125_062_023_478_026_1,
        viscous: 9.029_017_917_283_56,
        stribeck: 4.381_669_778_040_507,
        stribeck_speed: 1.977_086_206_494_623,
        alpha: 2.999_926_141_156_327_4,
        load: 2.126815651171455e-06,
        load_stribeck: 0.166_142_516_400_843_3,
        ..NONE
    },
    Drive {
        name: "erob80_100 m6",
        torque: 20.0,
        armature: 1.135_095_563_253_261_3,
        base: 0.000_477_966_533_583_621_1,
        viscous: 9.709_332_392_870_175,
        stribeck: 5.226_423_508_721_758_5,
        stribeck_speed: 2.033_034_439_197_855_6,
        alpha: 2.999_924_723_789_479_5,
        motor: 0.048_887_727_723_564_756,
        external: 7.626323416955297e-08,
        motor_stribeck: 8.823275901433639e-06,
        external_stribeck: 0.051_166_646_043_441_19,
        motor_square: 0.002_702_916_613_503_507_6,
        external_square: 0.002_556_257_557_735_874,
        ..NONE
    },
    Drive {
        name: "erob80_50 m1",
        torque: 20.0,
        armature: 0.336_938_735_772_574_6,
        base: 4.096_647_502_063_686,
        viscous: 1.298_057_952_952_93,
        ..NONE
    },
    Drive {
        name: "erob80_50 m2",
        torque: 20.0,
        armature: 0.334_516_263_043_823_2,
        base: 4.086_230_363_954_603,
        viscous: 1.313_199_344_607_048_5,
        stribeck: 1.6504871346024715e-08,
        stribeck_speed: 0.961_776_874_946_939_8,
        alpha: 1.438_935_728_332_229,
        ..NONE
    },
    Drive {
        name: "erob80_50 m4",
        torque: 20.0,
        armature: 0.333_830_529_860_265_3,
        base: 3.453_696_652_879_759,
        viscous: 1.216_634_943_303_125,
        stribeck: 9.218443879044224e-06,
        stribeck_speed: 0.346_013_873_162_219_76,
        alpha: 2.727_164_024_161_143,
        load: 0.063_087_286_411_809_34,
        load_stribeck: 7.125720330621117e-07,
        ..NONE
    },
    Drive {
        name: "erob80_50 m6",
        torque: 20.0,
        armature: 0.361_739_864_638_000_73,
        base: 3.258_936_577_427_873,
        viscous: 1.403_394_119_501_813,
        stribeck: 0.320_431_166_400_978_35,
        stribeck_speed: 2.830_385_649_014_235,
        alpha: 1.786_436_467_765_136_5,
        motor: 0.035_661_852_229_660_88,
        external: 0.000_843_165_943_570_880_2,
        motor_stribeck: 0.003_770_985_236_415_064,
        external_stribeck: 0.041_438_023_645_284_434,
        motor_square: 0.001_872_119_234_773_534_4,
        external_square: 0.001_599_099_113_872_436_5,
        ..NONE
    },
    Drive {
        name: "mx106 m1",
        torque: 2.0,
        armature: 0.026_609_234_235_148_084,
        base: 0.103_520_266_236_060_64,
        viscous: 0.035_202_380_290_135_07,
        ..NONE
    },
    Drive {
        name: "mx106 m2",
        torque: 2.0,
        armature: 0.026_838_831_911_873_175,
        base: 2.768555173702711e-06,
        viscous: 0.059_589_394_457_307_716,
        stribeck: 0.117_421_214_719_618_74,
        stribeck_speed: 1.848_780_549_429_907_4,
        alpha: 1.741_389_274_133_094_7,
        ..NONE
    },
    Drive {
        name: "mx106 m4",
        torque: 2.0,
        armature: 0.024_573_973_343_367_01,
        base: 6.653380436533205e-13,
        viscous: 0.050_960_825_060_109_55,
        stribeck: 0.104_910_607_715_688_66,
        stribeck_speed: 1.623_294_977_372_885_3,
        alpha: 1.323_485_668_999_259,
        load: 0.009_150_334_028_953_775,
        load_stribeck: 0.222_359_121_790_950_94,
        ..NONE
    },
    Drive {
        name: "mx106 m6",
        torque: 2.0,
        armature: 0.026_016_184_370_993_383,
        base: 1.0232526438525893e-05,
        viscous: 0.050_715_664_736_055_52,
        stribeck: 0.121_954_095_796_034_11,
        stribeck_speed: 1.746_325_174_132_872_7,
        alpha: 1.142_827_788_004_191,
        motor: 0.198_005_537_258_221_15,
        external: 0.022_215_529_897_348_624,
        motor_stribeck: 0.198_599_701_739_415_74,
        external_stribeck: 0.087_103_282_646_766_81,
        motor_square: 0.009_999_930_103_371_748,
        external_square: 7.326919843140997e-05,
        ..NONE
    },
    Drive {
        name: "sts3215 m1",
        torque: 0.8,
        armature: 0.028_403_363_486_820_85,
        base: 0.052_392_960_847_488_66,
        viscous: 0.059_085_155_650_910_76,
        ..NONE
    },
];
