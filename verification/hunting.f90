! Hunting of a wheelset (NDIM = 4) or of a wheelset under its bogie frame (NDIM = 6) for AUTO-07p,
! written from the equations of motion alone. State: y, y', psi, psi', z, z'.
!
! PAR(1) = V, PAR(11) = period (AUTO's own), PAR(21:42) = vehicle, in the order unpacked below,
! PAR(43) = eps, half width of the corner that rounds the dead band [m]:
!
!    max(x, 0)  ->  (x + sqrt(x^2 + eps^2)) / 2
!    F_T(y)      =  K_r [max(y - delta, 0) - max(-y - delta, 0)]
!
SUBROUTINE FUNC(NDIM, U, ICP, PAR, IJAC, F, DFDU, DFDP)
  IMPLICIT NONE
  INTEGER, INTENT(IN) :: NDIM, ICP(*), IJAC
  DOUBLE PRECISION, INTENT(IN) :: U(NDIM), PAR(*)
  DOUBLE PRECISION, INTENT(OUT) :: F(NDIM)
  DOUBLE PRECISION, INTENT(INOUT) :: DFDU(NDIM, NDIM), DFDP(NDIM, *)
  DOUBLE PRECISION :: V, m_w, I_wx, I_wy, r0, d, lam, W_A, b, Ky, Cy, Kpsi
  DOUBLE PRECISION :: f11, f22, f12, f33, Kr, delta, C1, C2, C3, C4, m_B, eps
  DOUBLE PRECISION :: y, vy, psi, w, z, vz, s, slip, up, down, rub, damper, vd
  DOUBLE PRECISION :: flange, stiffness, damping, Fy, Mpsi

  V = PAR(1)
  m_w = PAR(21); I_wx = PAR(22); I_wy = PAR(23); r0 = PAR(24); d = PAR(25); lam = PAR(26)
  W_A = PAR(27); b = PAR(28); Ky = PAR(29); Cy = PAR(30); Kpsi = PAR(31)
  f11 = PAR(32); f22 = PAR(33); f12 = PAR(34); f33 = PAR(35); Kr = PAR(36); delta = PAR(37)
  C1 = PAR(38); C2 = PAR(39); C3 = PAR(40); C4 = PAR(41); m_B = PAR(42); eps = PAR(43)

  y = U(1); vy = U(2); psi = U(3); w = U(4)
  z = 0; vz = 0
  IF (NDIM == 6) THEN
    z = U(5); vz = U(6)
  END IF

  s = 1 + r0*lam/d
  slip = s*vy - V*psi
  up = SQRT((y - delta)**2 + eps**2)
  down = SQRT((y + delta)**2 + eps**2)
  flange = Kr*((y - delta + up) + (y + delta - down))/2
  vd = b*w
  rub = ABS(vd)
  damper = C1*vd + C2*vd*rub + C3*vd**3 + C4*vd**3*rub

  Fy = -2*f11/V*slip - 2*f12/V*w - W_A*lam/d*y - 2*Ky*(y - z) - 2*Cy*(vy - vz) - flange
  Mpsi = -I_wy*V*lam/(r0*d)*vy - 2*d*lam*f33/r0*y + 2*f12/V*slip &
       - 2/V*(d**2*f33 + f22)*w + d*W_A*lam*psi - 2*Kpsi*b**2*psi - 2*b*damper

  F(1) = vy
  F(2) = Fy/m_w
  F(3) = w
  F(4) = Mpsi/I_wx
  IF (NDIM == 6) THEN
    F(5) = vz
    F(6) = (-2*Ky*(z - y) - 2*Cy*(vz - vy))/m_B
  END IF
  IF (IJAC == 0) RETURN

  stiffness = Kr*(2 + (y - delta)/up - (y + delta)/down)/2
  damping = C1 + 2*C2*rub + 3*C3*vd**2 + 4*C4*vd**2*rub
  DFDU = 0
  DFDU(1, 2) = 1
  DFDU(2, 1) = (-W_A*lam/d - 2*Ky - stiffness)/m_w
  DFDU(2, 2) = (-2*f11/V*s - 2*Cy)/m_w
  DFDU(2, 3) = 2*f11/m_w
  DFDU(2, 4) = -2*f12/V/m_w
  DFDU(3, 4) = 1
  DFDU(4, 1) = -2*d*lam*f33/r0/I_wx
  DFDU(4, 2) = (-I_wy*V*lam/(r0*d) + 2*f12/V*s)/I_wx
  DFDU(4, 3) = (-2*f12 + d*W_A*lam - 2*Kpsi*b**2)/I_wx
  DFDU(4, 4) = (-2/V*(d**2*f33 + f22) - 2*b**2*damping)/I_wx
  IF (NDIM == 6) THEN
    DFDU(2, 5) = 2*Ky/m_w
    DFDU(2, 6) = 2*Cy/m_w
    DFDU(5, 6) = 1
    DFDU(6, 1) = 2*Ky/m_B
    DFDU(6, 2) = 2*Cy/m_B
    DFDU(6, 5) = -2*Ky/m_B
    DFDU(6, 6) = -2*Cy/m_B
  END IF
  IF (IJAC == 1) RETURN

  DFDP(:, 1) = 0
  DFDP(2, 1) = 2*(f11*s*vy + f12*w)/V**2/m_w
  DFDP(4, 1) = (-I_wy*lam/(r0*d)*vy - 2*f12*s*vy/V**2 + 2*(d**2*f33 + f22)*w/V**2)/I_wx
END SUBROUTINE FUNC

SUBROUTINE STPNT(NDIM, U, PAR, T)
  IMPLICIT NONE
  INTEGER, INTENT(IN) :: NDIM
  DOUBLE PRECISION, INTENT(INOUT) :: U(NDIM), PAR(*)
  DOUBLE PRECISION, INTENT(IN) :: T
  U = 0  ! centred motion; all parameters come with the constants
END SUBROUTINE STPNT

! Largest |y| at the collocation points; the run ends on it, the exact peak is read off later.
SUBROUTINE PVLS(NDIM, U, PAR)
  IMPLICIT NONE
  INTEGER, INTENT(IN) :: NDIM
  DOUBLE PRECISION, INTENT(IN) :: U(NDIM)
  DOUBLE PRECISION, INTENT(INOUT) :: PAR(*)
  DOUBLE PRECISION, EXTERNAL :: GETP
  PAR(2) = MAX(GETP('MAX', 1, U), -GETP('MIN', 1, U))
END SUBROUTINE PVLS

SUBROUTINE BCND
END SUBROUTINE BCND

SUBROUTINE ICND
END SUBROUTINE ICND

SUBROUTINE FOPT
END SUBROUTINE FOPT
