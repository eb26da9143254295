"""The claims of the paper, word for word, and which check settles each: data, and nothing else.

`text` is the paper's own text, " […] " where something is left out. `check` names a function of loads.py, motion.py or
model.py and `given` its arguments; without one the claim cannot be checked here and `note` says why. `verdict` is what
the check is expected to find: a row that finds something else fails.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

__all__ = ["QUOTES", "Quote"]

CONFIRMED, DIGITS = "confirmed", "confirmed to the printed digits"
ERRATUM, OPEN = "erratum", "not checkable"


@dataclass(frozen=True)
class Quote:
    """A claim: where it stands, its words, the check and what it is expected to find; a note for the reader."""

    id: str
    section: str
    text: str
    check: str = ""
    given: Mapping[str, Any] = field(default_factory=dict)
    verdict: str = CONFIRMED
    note: str = ""


def _open(id_: str, section: str, text: str, why: str) -> Quote:
    return Quote(id_, section, text, verdict=OPEN, note=why)


DEFINITION = "a definition, or an assumption of the model: nothing is claimed that could be false"
AIM = "what the paper does or wants to do"
OTHERS = "what another paper did, which the text at hand does not hold"
PRACTICE = "of guidance, sensors and actuators the paper has no model"
FIGURES = "the text at hand holds no pictures; what it says of them is checked in rows of its own"

_LOW = "0.000001"

ABSTRACT = (
    Quote(
        "abstract-modes-needed", "abstract",
        "In order to derive the frequency of the system, the Ritz method has been used. The mode shapes of the system must therefore be extracted.",
        "without_modes", verdict=ERRATUM,
        note="The Ritz method needs admissible functions (section 3.1 says so itself), not mode shapes.",
    ),
    Quote(
        "abstract-more-force-more-motion", "abstract",
        "The results show that an increase in the follower and transversal forces leads to an increase of the vibrational motion of the beam",
        "more_is_more", {"places": ("0.1", "0.25", "1")}, ERRATUM,
        "For the transversal force it is true, the equations being linear. For the follower force it is true between the two loads and at the place of Fig. 10, and not in general.",
    ),
    _open("abstract-not-desirable", "abstract", "which is not desirable", PRACTICE),
    _open("abstract-model", "abstract", "a free-free uniform beam with damping effects subjected to follower and transversal forces at its end is considered as a model for a space structure", AIM),
    _open("abstract-damping-noted", "abstract", "Proportional damping model is used in this work, hence, the effects of both internal (material) and external (viscous fluid) damping on the system are noted.", AIM),
)  # fmt: skip

INTRODUCTION = (
    _open("1-importance", "1", "The stability of the beams under the axial or follower force is of vital importance and is of interest to many researchers in aerospace industry, as it can be applied to many aerospace structures.", "a judgement"),
    _open("1-directions", "1", "The direction of the axial force is assumed to be immovable while the direction of the follower force is always perpendicular to the cross surface of the beam and changes with the beam deflections.", DEFINITION),
    Quote(
        "1-frequencies", "1",
        "Axial or follower forces have a significant influence on the structural natural frequencies.",
        "frequencies_change", {"low": "0", "high": "50"},
    ),
    Quote(
        "1-axial-divergence", "1",
        "The critical axial force normally causes the static instability (divergence)",
        "dead_force",
    ),
    Quote(
        "1-follower-either", "1",
        "the critical follower force may cause static or dynamic instability (flutter)",
        "both_kinds",
    ),
    Quote(
        "1-divergence-zero", "1",
        "Divergence happens when the vibration frequency of the system becomes zero",
        "zero_frequency",
    ),
    Quote(
        "1-flutter-converge", "1",
        "flutter occurs when two natural frequencies of the systems converge together.",
        "only_coalescence", {"alpha": _LOW}, ERRATUM,
        "It defines undamped flutter, and contradicts the 88.2 of section 4.2. Used here: an eigenvalue that crosses the imaginary axis off zero.",
    ),
    _open("1-acceptable", "1", "This is an acceptable model for such structures with a propulsion force and a controller force.", "a judgement, for which the paper gives no comparison"),
    _open("1-objective", "1", "The main objective pursued in the paper is to determine the maximum follower force structurally bearable in such a way as to prevent instability of the structure.", AIM),
    Quote(
        "1-damping-matters", "1",
        "It will be shown that the proportional damping has a significant effect on this maximum follower force.",
        "significant", {"alpha": _LOW},
    ),
    Quote(
        "1-more-force-more-motion", "1",
        "It will also be shown that increasing the follower force or the transversal force results in an increase in the vibrational movement of the inertial measurement units (IMU).",
        "more_is_more", {"places": ("0.1", "0.25", "1")}, ERRATUM,
        "As in the abstract: true between the two loads of Fig. 10, at its place.",
    ),
    _open("1-guidance", "1", "This in turn causes an inaccuracy in the guidance system and performance degradation in the actuators.", PRACTICE),
    _open("1-bokaian", "1", "Bokaian (1988) obtained an analytical characteristic equation for uniform beams under constant compressive axial load", OTHERS),
    _open("1-thana", "1", "Thana and Ameen (2007) addressed the dynamic stability problem of columns and frames subjected to the axially-applied periodic loads.", OTHERS),
    _open("1-hassanpour", "1", "Hassanpour *et al.* (2007) analyzed the exact solution of free vibration of a beam with a concentrated mass within its intervals when the beam was subjected to axial loadings.", OTHERS),
    _open("1-joshi", "1", "Joshi (1995) established a simple method to determine the mode shapes and the natural frequencies of a non-uniform beam subjected to rear end propulsion force.", OTHERS),
    _open("1-nihous", "1", "Another research to obtain the governing vibration equations and the stability of a beam under axial force was carried out by Nihous (1997).", OTHERS),
    _open("1-pourtakdoust", "1", "Pourtakdoust and Assadian (2004) modeled a free-free Bernoulli-Euler beam under an axial force. The three dimensional elastic equations of vibration are solved by the FEM. Only the divergence was found and shown in their work.", OTHERS),
    _open("1-lee-1995", "1", "Lee (1995) formulated the equation of motion in matrix form of a cantilever Bernoulli-Euler beam subject to a tip-concentrated follower force at the free end", OTHERS),
    _open("1-zuo", "1", "Zuo and Schreyer (1996) studied the instability of a cantilevered beam and a simply supported plate, subjected to a combination of fixed and follower forces.", OTHERS),
    _open("1-langthjem-1999", "1", "Langthjem and Sugiyama (1999) studied a cantilever beam under a follower force with a tip mass to optimize the design of the beam.", OTHERS),
    _open("1-au", "1", "Another research on the instability of a non-uniform cantilever beam under a follower force was done by Au et al. (1999) using finite element method.", OTHERS),
    _open("1-langthjem-2000", "1", "Langthjem and Sugiyama (2000) offered a survey of simple, flexible structural elements subjected to nonconservative follower loads.", OTHERS),
    _open("1-detinko-2002", "1", "Detinko (2002) analyzed simple model of a slender beam loaded by a transverse follower force and undergoing a lateral flutter.", OTHERS),
    _open("1-wang-quek", "1", "Wang and Quek (2002) illustrated the use of a pair of piezoelectric layers in increasing the flutter and buckling capacity of a column subjected to a follower force.", OTHERS),
    _open("1-kurnik", "1", "Kurnik and Przybyłowicz (2003) analyzed active stabilisation of self-excited vibration of slender rotating columns subject to tangential follower forces. Such systems exhibit flutter-type instability as a result of energy transfer from rotation and to transverse motion of the shaft.", OTHERS),
    _open("1-young", "1", "Young and Juan (2003) presented a study of non-linear response of a fluttered, cantilevered beam subjected to a random follower force at the free end.", OTHERS),
    _open("1-wang-2004", "1", "Wang (2004) presented a comprehensive analysis of the stability of a cracked beam subjected to a follower compressive load.", OTHERS),
    _open("1-ravi-kumar", "1", "Ravi Kumar et al. (2005) dealt with the study of vibration and dynamic instability characteristics of laminated composite doubly curved panels, subjected to non-uniform follower load, using finite element approach.", OTHERS),
    _open("1-luongo", "1", "Luongo and Di Egidio (2006) studied an internally constrained planar beam, equipped with a lumped visco-elastic device and loaded by a follower force.", OTHERS),
    _open("1-paolone", "1", "Paolone et al. (2006) analyzed the stability of a cantilever elastic beam with rectangular cross-section under the action of a follower tangential force and a bending conservative couple at the free end.", OTHERS),
    _open("1-elfelsoufi", "1", "Elfelsoufi and Azrar (2006) presented a mathematical model based on integral equations for numerical investigations of stability analyses of damped beams subjected to sub-tangential follower forces.", OTHERS),
    _open("1-many", "1", "Many researchers have also published their work on cantilever beam under a follower force with damping", OTHERS),
    _open("1-sugiyama", "1", "Sugiyama and Langthjem (2007) studied cantilever beam under a follower force with proportional damping. Both internal (material) and external (viscous fluid) damping were considered.", OTHERS),
    _open("1-tomski", "1", "Tomski et al. (2007) presented the results of theoretical and numerical studies on the slender, geometrically nonlinear system supported at the loaded end by a spring of a linear characteristic", OTHERS),
    _open("1-shvartsman", "1", "The large-deflection problem of a non-uniform spring-hinged cantilever beam under a tip-concentrated follower force was considered by Shvartsman (2007).", OTHERS),
    _open("1-katsikadelis", "1", "Shape optimization was used to optimize the critical load of an Euler-Bernoulli cantilever beam with constant volume subjected to a tangential compressive tip load and/or a tangential compressive load arbitrarily distributed along the beam by Katsikadelis and Tsiatas (2007).", OTHERS),
    _open("1-de-rosa", "1", "De Rosa et al. (2008) dealt with the dynamic behavior of a clamped beam subjected to a sub-tangential follower force at the free end.", OTHERS),
    _open("1-djondjorov", "1", "Djondjorov and Vassilev (2008) have studied the dynamic stability of a cantilevered Timoshenko beam lying on an elastic foundation of Winkler type and subjected to a tangential follower force.", OTHERS),
    _open("1-attard", "1", "Attard et al. (2008) have investigated the dynamic stability behaviors of damped Beck's columns subjected to sub-tangential follower forces using fifth-order Hermitian beam elements.", OTHERS),
    _open("1-marzani", "1", "Marzani et al. (2008) have applied the generalized differential quadrature (GDQ) method to solve classical and non-classical non-conservative stability problems.", OTHERS),
    Quote(
        "1-beal-tumbling", "1",
        "He introduced a direction control mechanism for the follower force to eliminate the tumbling instability of a freefree beam under a follower force.",
        "tumbling", note="That the free beam tumbles is checked; Beal's control law is not in the text.",
    ),
    Quote(
        "1-beal-coalescence", "1",
        "in the absence of a control system, the magnitude of the critical follower force is associated with coalescence of the two lowest bending frequencies.",
        "lowest_two_meet",
    ),
    _open("1-beal-control", "1", "When the control system was included, it was found that the magnitude of the critical follower force only corresponded to a reduction of the lowest frequency of zero.", "the control law is not stated"),
    _open("1-wu", "1", "Wu (1975) studied the stability of a free-free beam under a controlled follower force by using finite element discretization with an adjoint formulation.", OTHERS),
    _open("1-park-mote", "1", "Park and Mote, jr. (1984) studied the maximum controlled follower force on a free-free beam carrying a concentrated mass.", OTHERS),
    _open("1-park", "1", "Park (1987) investigated a uniform free-free Timoshenko beam under an end follower force with controlled direction. […] The analysis showed that the effects of the rotary inertia and shear deformation parameters on the stable transverse motion of the beam are significant in certain ranges.", OTHERS),
    _open("1-sato", "1", "Sato (1991) developed the governing equation of motion of a Timoshenko beam under a follower force using Hamilton's principle.", OTHERS),
    _open("1-mladenov", "1", "Mladenov and Sugiyama (1997) dealt with the stability of a flexible space structure subjected to an end follower force. […] Bending flutter or post-flutter divergence showed to occur depending on the joint rigidity and internal damping.", OTHERS),
    _open("1-kim", "1", "Kim and Choo (1998) analyzed the dynamic stability of a free-free Timoshenko beam with a concentrated mass subjected to a pulsating follower force.", OTHERS),
)  # fmt: skip

MODELING = (
    _open("2-assumptions", "2", "The beam is assumed to be axially rigid and is a Bernoulli-Euler beam. The gravity force is also ignored.", DEFINITION),
    Quote(
        "2-axial-force", "2",
        "To calculate the axial force along the beam, the equilibrium dynamics can be used as (Wu 1975)",
        "as_equations", {"numbers": (3,), "what": "Newton's law for the part of the beam between its free end and a section gives P₀x/L: Eq. (3)"},
    ),
    Quote(
        "2-substitution", "2",
        "By substituting Eqs. (3), (4), and (5) in Eq. (2), Eq. (6) is obtained as the following",
        "as_equations", {"numbers": (2, 3, 5, 6), "what": "Eq. (2) with Eqs. (3) and (5) put in is the derived Eq. (6), term by term; Eq. (4) needs its delta in the nondimensional place, and the order of the internal damping is misprinted in Eq. (6)"},
        note="See Eqs. (4) and (6) for the misprints.",
    ),
    Quote(
        "2-nondimensional", "2",
        "As Eq. (6) shows, all the parameters in this equation are in non-dimensional form.",
        "as_equations", {"numbers": (5,), "what": "kilogram, metre and second drop out of each of the seven quantities of Eq. (5)"},
    ),
    Quote(
        "2-not-analytical", "2",
        "Considering the fact that the axial force distribution on the beam is not constant, the governing differential equation cannot be solved analytically and an approximation method must be used.",
        "without_approximation", verdict=ERRATUM,
        note="It has no solution in elementary functions; a convergent power series it has, with a rigorous bound of its tail, and thereby the exact critical load.",
    ),
    Quote(
        "2-galerkin", "2",
        "It is noted that some approximation methods such as the Galerkin method (Hodges and Pierce 2002) need the governing equation of motion, which explains why Eq. (6) is introduced.",
        "galerkin",
    ),
    _open("2-kantorovich", "2", "In this study the Kantorovich method has been employed, which uses the Hamilton's principle (Hodges and Pierce 2002).", AIM),
)  # fmt: skip

METHOD = (
    _open("3-admissible-series", "3", r"where  $\varphi_i(\bar{x})$  is assumed an admissible function and  $q_i(\bar{t})$  is a generalized coordinate.", DEFINITION),
    Quote(
        "3-ordinary", "3",
        "As a common rule, in the approximate solution methods, a partial differential equation may be put into a set of ordinary differential equations.",
        "as_equations", {"numbers": (9, 10), "what": "Eq. (9) put into the energies gives Eq. (10), N ordinary differential equations"},
    ),
    Quote(
        "3-damping-matrix", "3",
        r"the damping matrix of the system (using proportional damping model) does not appear as  $[C_{ij}] = \overline{\beta}[M_{ij}] + \overline{\alpha}[K_{ij}]$ , and a part of the stiffness matrix of the system that consists of the follower force (geometrical stiffness) does not enter in the damping matrix of the system.",
        "as_equations", {"numbers": (12,), "what": "C = βM + α(K − Kᴳ) is an identity of the derived forms, C = βM + αK is none"},
    ),
    _open("3.1-conditions", "3.1", r"In general, the admissible functions  $\varphi(\bar{x})$  must satisfy the following four conditions:", DEFINITION),
    Quote(
        "3.1-admissible", "3.1",
        "The mode shapes of a free-free beam with proportional damping satisfy the above conditions and have been used in this study.",
        "complete", verdict=ERRATUM,
        note="The four conditions hold for all modes together, the rigid ones included; those used leave them out.",
    ),
    Quote(
        "3.1-rigid", "3.1",
        "As the first two rigid body modes are not involved in the instability, they are not considered as the admissible functions (Beal 1965).",
        "rigid_apart",
        note="A theorem, not an assumption; it holds with external damping too.",
    ),
    Quote(
        "3.1-same-shapes", "3.1",
        "the characteristic equation and bending mode shapes of a freefree uniform Bernoulli-Euler beam with proportional damping are not different from those obtained for the same beam without damping effects, but the frequencies of the two systems are different from each other.",
        "as_equations", {"numbers": (19, 20, 21, 22, 23), "what": "Eqs. (19) to (22) hold neither α nor β, Eq. (23) holds both"},
    ),
    Quote(
        "3.1-second-term", "3.1",
        "The second term in the right-hand side of Eq. (23) illustrates the bending frequencies of a uniform free-free Bernoulli-Euler beam with proportional damping.",
        "second_term", {"alpha": "0.1"}, ERRATUM,
        "True so long as the mode is not overdamped; see Eq. (26).",
    ),
    _open("3.2-objective", "3.2", r"The most important objective of the present study is to determine the magnitude and type of the least follower force (the divergence or flutter) leading to instability  $\overline{P}_{0cr}$ .", AIM),
    Quote(
        "3.2-frequencies-change", "3.2",
        "As seen in Eq. (11), the follower force affects the system stiffness matrix and changes the system frequencies.",
        "frequencies_change", {"low": "0", "high": "100"},
    ),
    Quote(
        "3.2-eigenvalues", "3.2",
        "Clearly, the system frequencies are the eigenvalues of this matrix.",
        "as_equations", {"numbers": (24, 25), "what": "A (q, λq) = λ (q, λq) is (λ²M + λC + K) q = 0; the frequencies are |Im λ|"},
    ),
    _open("3.2-newmark", "3.2", "These parameters are calculated by solving Eq. (10) for which the Newmark method (Craig, Jr and Kurdila (2006)) is utilized in this paper.", AIM),
    Quote(
        "3.2-eight", "3.2",
        "in all the studies in this paper, as many as eight terms of the mode shapes are considered (N=8).",
        "modes_used", {"count": 8}, DIGITS,
        "No other number of modes gives all four printed critical loads.",
    ),
)  # fmt: skip

UNDAMPED = (
    _open("4.1-validity", "4.1", r"To assure the validity of the computer code first, the case of  $\overline{\alpha} = 0$  and  $\overline{\beta} = 0$  is considered.", AIM),
    Quote("4.1-load", "4.1", "the value of the critical follower force is obtained as 109.8", "scan", {"printed": "109.8"}, DIGITS),
    Quote("4.1-beal", "4.1", "the value cited by Beal (1965), namely 109.9", "beal", {"value": "109.9"}, DIGITS, "Explained as a series of five bending modes (seven functions with the two rigid ones); the beam itself has 109.69. Beal's own text is not at hand."),
    Quote("4.1-comparable", "4.1", "which is very closely comparable with the value cited by Beal (1965), namely 109.9", "near_beal", {"value": "109.9"}),
    Quote(
        "4.1-coincide", "4.1",
        r"By increasing the value of  $\overline{P}_0$ , the values of  $\overline{\lambda}_{I1}$  and  $\overline{\lambda}_{I2}$  are changed and they will coincide each other at  $\overline{P}_0 = 109.8$ .",
        "coalescence", {"printed": "109.8", "below": "109.7"}, DIGITS,
    ),
    Quote(
        "4.1-equal-real-parts", "4.1",
        r"It is precisely at this value of  $\overline{P}_0$  at which  $\overline{\lambda}_{R1}$  and  $\overline{\lambda}_{R2}$  which are equal to each other take positive sign",
        "equal_real_parts", {"load": "109.8"}, ERRATUM,
        "They are ±r: one grows, the other decays.",
    ),
    Quote("4.1-instability", "4.1", r"hence ensuing instability at  $\overline{P}_{0cr} = 109.8$ .", "scan", {"printed": "109.8"}, DIGITS),
    Quote(
        "4.1-flutter", "4.1",
        r"Since this value of  $\overline{P}_{0cr}$  makes the amplitude of vibration increase with time, the resulting instability is called dynamic instability or flutter.",
        "grows", {"load": "109.8"},
    ),
    Quote(
        "4.1-moves-right", "4.1",
        r"if the value of  $\overline{P}_0$  increases, the eigenvalues of matrix A move to the right hand side of the complex plane, leading to instability.",
        "moves_right", {"loads": ("100", "109.7", "109.8", "111", "112")},
        note="One of the two that met does; the other moves to the left.",
    ),
    Quote(
        "4.1-two-figures", "4.1",
        r"only one significant figure after the decimal point was considered for the […] accuracy of the  $\overline{P}_0$  variation. If two significant figures after the decimal point had been considered instead, then the value would have been  $\overline{P}_{0cr} = 109.73$ .",
        "scan", {"printed": "109.73"}, DIGITS,
    ),
    _open("4.1-figures", "4.1", "The eigenvalues of the matrix A in Eq. (25) were calculated and illustrated in Figs. 2 and 3.", FIGURES),
)  # fmt: skip

INTERNAL = (
    Quote(
        "4.2-sudden", "4.2",
        r"with the smallest value considered for  $\overline{\alpha}$  as  $\overline{\alpha} = 10^{-6}$ , the critical follower force leading to flutter is suddenly decreased from 109.73 to 88.2.",
        "scans", {"first": "109.73", "second": "88.2", "alpha": _LOW}, DIGITS,
    ),
    Quote(
        "4.2-constant", "4.2",
        r"For the  $\overline{\alpha}$  values in the range  $10^{-6} \le \overline{\alpha} \le 10^{-3}$ , the value of the critical follower force remains constant.",
        "constant", {"which": "internal", "low": _LOW, "high": "0.001", "printed": "88.2"}, DIGITS,
        "Constant in the printed digits; the value itself rises.",
    ),
    Quote(
        "4.2-rises", "4.2",
        r"in the range  $10^{-3} < \overline{\alpha} \le 10^{-1}$ , the value of the critical follower force increased.",
        "rises", {"which": "internal", "low": "0.001", "high": "0.1", "none_before": "0.03"},
    ),
    Quote(
        "4.2-cantilever", "4.2",
        "The nature of these variations in a free-free beam is similar to that in a cantilever beam (Sugiyama and Langthjem 2007).",
        "cantilever", {"which": "internal"},
    ),
)  # fmt: skip

EXTERNAL = (
    Quote(
        "4.3-constant", "4.3",
        r"small values of  $\overline{\beta}$  within the range  $10^{-2} \le \overline{\beta} \le 10^{-1}$ , do not cause any change in the critical follower force and the value of this parameter remains unchanged at 109.73, the value obtained for the case of without damping effects.",
        "constant", {"which": "external", "low": "0.01", "high": "0.1", "printed": "109.73"}, DIGITS,
        "Unchanged in the printed digits; the value itself rises.",
    ),
    Quote(
        "4.3-range", "4.3",
        r"For the  $\overline{\beta}$  values in the range  $10^{-1} < \overline{\beta} \ge 10^{0}$ ",
        "range_sign", {"low": "0.1", "high": "1"}, ERRATUM, "A misprint of the second sign.",
    ),
    Quote(
        "4.3-rises", "4.3",
        "the value of the critical follower force increased. Although",
        "digits_change", {"which": "external", "low": "0.1", "high": "1", "printed": "109.73"},
        note="With the range as section 5 prints it.",
    ),
    Quote(
        "4.3-negligible", "4.3",
        r"these variations are negligible in contrast with the previous case ( $\overline{\beta} = 0$ ,  $\overline{\alpha} \ne 0$ )",
        "negligible", {"low": "0.001", "high": "1"},
    ),
    Quote(
        "4.3-greater", "4.3",
        r"the value of the critical follower force is greater than the previous value calculated without damping effects ( $\overline{\beta} = 0$ ,  $\overline{\alpha} = 0$ ).",
        "rises", {"which": "external", "low": "0.01", "high": "1", "above_undamped": True, "none_before": "0.03"},
    ),
    Quote(
        "4.3-cantilever", "4.3",
        "The nature of these variations in a free-free beam is similar to that for a cantilever beam (Sugiyama and Langthjem 2007).",
        "cantilever", {"which": "external"},
    ),
)  # fmt: skip

BOTH = (
    Quote("4.4-different-forms", "4.4", r"these two parameters affect the  $\overline{P}_{0cr}$  in different forms.", "different_forms"),
    Quote(
        "4.4-rises-with-beta", "4.4",
        r"there exists a specific value of  $\overline{\alpha}$  at which increasing the  $\overline{\beta}$  leads to a rise in the critical follower force",
        "rises", {"which": "external", "low": "0.01", "high": "1", "held": "0.001", "none_before": "0.03"},
    ),
    Quote(
        "4.4-falls-then-rises", "4.4",
        r"at a specific value of  $\overline{\beta}$ , an increase in the  $\overline{\alpha}$  will at first lead to a decrease of the value of the critical follower force, and brings about a rise in this parameter later.",
        "falls_then_rises", {"low": _LOW, "high": "0.1", "held": "0.1"},
    ),
    Quote(
        "4.4-left-to-right", "4.4",
        r"a change in the value of  $\overline{P}_0$  will move the eigenvalues from the left hand side of the complex plane to its right hand side.",
        "moves_right", {"loads": ("0", "50", "90.8", "90.9", "100", "112"), "alpha": "0.001", "beta": "0.1"},
        note="One pair of them.",
    ),
    Quote(
        "4.4-load", "4.4",
        r"At  $\overline{P}_0 = 90.9$ , the real part of the eigenvalue becomes positive and so the critical follower force for this case equals to 90.9.",
        "moves_right", {"loads": ("90.8", "90.9"), "alpha": "0.001", "beta": "0.1", "printed": "90.9"}, DIGITS,
    ),
)  # fmt: skip

VIBRATION = (
    _open("4.5-parameters", "4.5", r"assuming  $\bar{\alpha} = 0.001$ ,  $\bar{\beta} = 0.1$ ,  $\bar{x}_{F_0} = 1$ ,  $\bar{P}_0 = 5$ , and  $\bar{P}_0 = 50$  for the two different cases of  $\bar{F}_0 = 0.001 \sin(3\bar{t})$  and  $\bar{F}_0 = 0.002 \sin(3\bar{t})$ .", "parameters, chosen; the rows below are computed with them"),
    Quote("4.5-load", "4.5", r"for these parameter values, the critical follower force is  $\bar{P}_{0_{cr}} = 90.9$ .", "scan", {"printed": "90.9", "alpha": "0.001", "beta": "0.1"}, DIGITS),
    Quote(
        "4.5-decays", "4.5",
        r"This is the case whereby  $\bar{P}_0 = 9$ . As shown in Fig. 8, the vibrational amplitude decreases with time.",
        "decays", {"loads": ("9",)},
        note="For any initial condition, in the end; the one of Fig. 8 is not stated.",
    ),
    Quote(
        "4.5-lyapunov", "4.5",
        "from which one can demonstrate stability of the system for this follower force using the Lyapunov's methods.",
        "stable_by_lyapunov", {"load": "9"},
    ),
    Quote("4.5-unstable", "4.5", r"Similar results were also obtained for the case of  $\bar{P}_0 = 112$  presented in Fig. 9, which shows instability of the system.", "unstable", {"load": "112"}),
    _open("4.5-initial", "4.5", r"Fig. 8 shows the vibrational properties with the  $\bar{x}_s = 0.1$  as a function of time for a given initial condition.", "the initial condition is not given, and " + FIGURES),
    Quote("4.5-small-force", "4.5", "The magnitude of the transversal force is selected to be considerably smaller than that of the follower force.", "small_force", {"force": "0.002", "load": "5"}),
    Quote("4.5-slow-force", "4.5", "the frequency is also taken to be smaller than that of the model.", "slow_force", {"frequency": "3", "loads": ("5", "50")}),
    Quote(
        "4.5-more-load", "4.5",
        r"It is observed that increasing the follower […] force results in an increase in the motion of the  $\bar{x}_s$  of the beam.",
        "more_load", {"low": "5", "high": "50"},
        note="By how much depends on the follower term: as printed it is more than twice as much (Eq. (11)).",
    ),
    Quote(
        "4.5-more-force", "4.5",
        r"It is observed that increasing the […] transversal force results in an increase in the motion of the  $\bar{x}_s$  of the beam.",
        "more_force", {"first": "0.001", "second": "0.002"},
    ),
    _open("4.5-destructive", "4.5", "motion is a destructive phenomenon for the control system of the aerospace structure and hence it must be remedied by proper approaches.", PRACTICE),
    Quote(
        "4.5-oscillation-dies", "4.5",
        r"the oscillatory effects in the displacement at the  $\bar{x}_s$  position for the two values of  $\bar{P}_0$  and  $\bar{F}_0$  tend to eliminate in time due to the presence of damping effects.",
        "decays", {"loads": ("5", "50")},
        note="Those of the free motion; what the force maintains stays.",
    ),
    Quote(
        "4.5-fixed-value", "4.5",
        r"the amplitude of displacement of the  $\bar{x}_s$  position tends to a fixed value.",
        "fixed_amplitude", {"loads": ("5", "50")}, ERRATUM,
        "True of the elastic part, which is all that the paper's eight modes hold. The free beam itself turns and drifts away.",
    ),
    Quote(
        "4.5-proportional", "4.5",
        r"For a given set of values for  $\bar{P}_0$  and  $\bar{F}_0$  in time, point  $\bar{x}_s$  is displaced proportional to the amplitude and frequency of the exited force.",
        "follows_the_force", {"frequency": "3", "other": "6"}, ERRATUM,
        "Proportional to the amplitude, and with the frequency of the force; not proportional to it.",
    ),
)  # fmt: skip

CONCLUSIONS = (
    Quote("5-load", "5", r"At first for the model without damping, the critical follower force leading to flutter was obtained as  $\overline{P}_{0_{rr}} = 109.73$ .", "scan", {"printed": "109.73"}, DIGITS),
    Quote("5-moves-right", "5", "dynamic instability occurs since the eigenvalues of matrix A move to the right hand side of the complex plane.", "moves_right", {"loads": ("100", "109.7", "109.8", "111", "112")}),
    Quote(
        "5-with-damping", "5",
        r"The dynamic instability due to an increase in the magnitude of  $\overline{P}_0$  and in the presence of proportional damping occurred in the simulation results.",
        "grows", {"load": "112", "alpha": "0.001", "beta": "0.1"},
    ),
    Quote(
        "5-sudden", "5",
        r"In the case of  $\overline{\alpha} \neq 0$  and  $\overline{\beta} = 0$  for the smallest value of  $\overline{\alpha}$ , namely  $\overline{\alpha} = 10^{-6}$ , the critical follower force suddenly decreased from 109.73 to 88.2.",
        "scans", {"first": "109.73", "second": "88.2", "alpha": _LOW}, DIGITS,
    ),
    Quote(
        "5-constant-alpha", "5",
        r"In the range  $10^{-6} \le \overline{\alpha} \le 10^{-3}$ , the value of critical follower force remained constant",
        "constant", {"which": "internal", "low": _LOW, "high": "0.001", "printed": "88.2"}, DIGITS,
    ),
    Quote(
        "5-rises-alpha", "5",
        r"in the range  $10^{-3} < \overline{\alpha} \le 10^{-1}$ , the value of critical follower force increased.",
        "rises", {"which": "internal", "low": "0.001", "high": "0.1", "none_before": "0.03"},
    ),
    Quote("5-flutter-alpha", "5", "In this case, all the obtained critical follower force increased. […] follower forces cause flutter to occur.", "flutter_everywhere", {"which": "internal"}, note="The text at hand repeats half a sentence."),
    Quote(
        "5-constant-beta", "5",
        r"the small values of  $\overline{\beta}$  in the range  $10^{-2} \le \overline{\beta} \le 10^{-1}$  do not cause any change in the magnitude of the critical follower force, which remained in this order as for the no damping case, i.e.,  $\overline{P}_{0_{cr}} = 109.73$ .",
        "constant", {"which": "external", "low": "0.01", "high": "0.1", "printed": "109.73"}, DIGITS,
    ),
    Quote(
        "5-rises-beta", "5",
        r"In the range  $10^{-1} < \overline{\beta} \le 10^{\circ}$ , the value of critical follower force increased",
        "digits_change", {"which": "external", "low": "0.1", "high": "1", "printed": "109.73"},
    ),
    Quote("5-stabilizing", "5", "(in fact, this type of damping alone has a stabilizing effect)", "rises", {"which": "external", "low": "0.01", "high": "1", "above_undamped": True, "none_before": "0.03"}),
    Quote("5-flutter-beta", "5", "In this case again, all the obtained critical follower forces caused flutter to occur.", "flutter_everywhere", {"which": "external"}),
    Quote(
        "5-complicated", "5",
        r"The dependence of the critical follower force on the internal damping factor becomes more complicated when external damping is also included",
        "different_forms",
    ),
    Quote("5-different-manners", "5", r"parameters affect the  $\overline{P}_{0cr}$  in different manners.", "different_forms"),
    Quote(
        "5-rises-with-beta", "5",
        r"Generally, one can conclude that at a given value of  $\overline{\alpha}$ , increasing the value of  $\overline{\beta}$  leads to a rise in the critical follower force",
        "map_rises_with_beta",
    ),
    Quote(
        "5-falls-then-rises", "5",
        r"at a given value of  $\overline{\beta}$ , increasing the value of  $\overline{\alpha}$  leads to a decrease in the value of the critical follower force at first, and then causes a rise in this parameter later.",
        "map_falls_then_rises",
    ),
    Quote("5-flutter-both", "5", "In this case again, all the obtained critical follower forces cause flutter to occur.", "flutter_everywhere", {"which": "both"}),
    Quote(
        "5-can-increase", "5",
        r"In general, increasing the follower or transversal force can lead to an increase in the vibration of the point  $\bar{x}_s$ ",
        "can_be_more", note="It can; it need not: see the abstract.",
    ),
    _open("5-not-desirable", "5", "which is not desirable for a control system and hence it must be remedied by proper approaches.", PRACTICE),
    Quote(
        "5-damped-out", "5",
        r"In the case in which the beam has a proportional damping, the oscillatory effects of the displacement at the  $\bar{x}_s$  position on the beam are damped out in time. But in the model without such damping, these oscillatory effects persist with time.",
        "dies_and_persists", {"loads": ("5", "50")},
    ),
)  # fmt: skip

QUOTES: tuple[Quote, ...] = (
    *ABSTRACT,
    *INTRODUCTION,
    *MODELING,
    *METHOD,
    *UNDAMPED,
    *INTERNAL,
    *EXTERNAL,
    *BOTH,
    *VIBRATION,
    *CONCLUSIONS,
)
