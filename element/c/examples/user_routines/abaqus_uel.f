C     An Abaqus/Standard user element (UEL) of the wheel-rail contact.
C     UNTRIED in Abaqus; abaqus_uel_driver.c calls it in its place.
C     Compare the argument list with the manual of your version.
C
C     Build: give it to Abaqus as the user subroutine of the job, and
C     link the library as the manual says. For the driver:
C     gfortran -O2 -c abaqus_uel.f
C
C     *USER ELEMENT, TYPE=U1, NODES=2, COORDINATES=3, PROPERTIES=3,
C     VARIABLES=20, UNSYMM
C     2, 3, 4
C     Node 1 is the rim (at the origin of the wheel's profile). Node 2
C     is the rail's section (at its line of shear centres). The dofs
C     are y, z and rotation about x, with z down. Displacements count
C     from where the wheel just touches. Inertia and the flexibility of
C     the bodies are Abaqus's. Coordinates of the nodes are not used.
C
C     PROPS(1) is the place of the wheel at total time 0 (m), PROPS(2)
C     its speed (m/s). PROPS(3) is the coefficient of friction; a value
C     less than 0 takes the study's.
C     A rail of your own has PROPS(1) -1 and PROPS(2) 0.
C     The environment variable RAILSPRING_ELEMENT names the file.
C
C     The state of friction is in the library. SVARS(1) counts the
C     increments that converged. SVARS(2:8) are the motions at the end
C     of the last one. SVARS(9:14) are the forces there: minus (9) and
C     minus (10) are Q and P. SVARS(15:20) are the forces an increment
C     before, which half-increment residuals need.
C     Abaqus gives SVARS as at the start of the increment. Where they
C     count one more than was committed, a new increment has begun.
C     The motions that converged are then evaluated again and committed.
C     A cut-back (KINC again, SVARS as before) commits nothing.
C     Evaluating has no side effect. A restart from another job is
C     refused. The contacts are in a module: use one process and thread.
      MODULE RAILSPRING_ABAQUS
      USE, INTRINSIC :: ISO_C_BINDING
      USE, INTRINSIC :: IEEE_ARITHMETIC
      IMPLICIT NONE
      INTEGER, PARAMETER :: MOST=1000
      TYPE, BIND(C) :: RMOTIONS
        REAL(C_DOUBLE) :: RIM(3), SECTION(3), PLACE
      END TYPE
C     The tangent comes by rows: here it is TANGENT(column, row).
      TYPE, BIND(C) :: RFORCES
        REAL(C_DOUBLE) :: RIM(3), SECTION(3), TANGENT(6,6)
      END TYPE
      TYPE(C_PTR), SAVE :: CONTACT(MOST)=C_NULL_PTR
      INTEGER, SAVE :: TAKEN(MOST)=0, STEP(MOST)=0, INC(MOST)=0
      INTERFACE
        INTEGER(C_INT) FUNCTION RELEMENT_OPEN(PATH, ELEMENT)
     1   BIND(C, NAME='railspring_element_open')
        IMPORT
        CHARACTER(KIND=C_CHAR), INTENT(IN) :: PATH(*)
        TYPE(C_PTR), INTENT(OUT) :: ELEMENT
        END FUNCTION
        SUBROUTINE RELEMENT_FREE(ELEMENT)
     1   BIND(C, NAME='railspring_element_free')
        IMPORT
        TYPE(C_PTR), VALUE :: ELEMENT
        END SUBROUTINE
        INTEGER(C_INT) FUNCTION RCONTACT_NEW(ELEMENT, MU, CONTACT)
     1   BIND(C, NAME='railspring_contact_new')
        IMPORT
        TYPE(C_PTR), VALUE :: ELEMENT
        REAL(C_DOUBLE), VALUE :: MU
        TYPE(C_PTR), INTENT(OUT) :: CONTACT
        END FUNCTION
        INTEGER(C_INT) FUNCTION RCONTACT_START(CONTACT, AT, FORCES)
     1   BIND(C, NAME='railspring_contact_start')
        IMPORT
        TYPE(C_PTR), VALUE :: CONTACT
        TYPE(RMOTIONS), INTENT(IN) :: AT
        TYPE(RFORCES), INTENT(OUT) :: FORCES
        END FUNCTION
        INTEGER(C_INT) FUNCTION RCONTACT_EVALUATE(CONTACT, AT, FORCES)
     1   BIND(C, NAME='railspring_contact_evaluate')
        IMPORT
        TYPE(C_PTR), VALUE :: CONTACT
        TYPE(RMOTIONS), INTENT(IN) :: AT
        TYPE(RFORCES), INTENT(OUT) :: FORCES
        END FUNCTION
        INTEGER(C_INT) FUNCTION RCONTACT_COMMIT(CONTACT)
     1   BIND(C, NAME='railspring_contact_commit')
        IMPORT
        TYPE(C_PTR), VALUE :: CONTACT
        END FUNCTION
        TYPE(C_PTR) FUNCTION RMESSAGE()
     1   BIND(C, NAME='railspring_message')
        IMPORT
        END FUNCTION
      END INTERFACE
      CONTAINS

C     Writes what was wrong. After numerics (3), or motions of an
C     iteration that are out of range (2), a shorter increment may do.
C     A defect (4) ends the run.
      SUBROUTINE RAILSPRING_REPORT(JELEM, CODE)
      INTEGER, INTENT(IN) :: JELEM, CODE
      CHARACTER(KIND=C_CHAR), POINTER :: TEXT(:)
      INTEGER :: N
      CALL C_F_POINTER(RMESSAGE(), TEXT, (/4096/))
      N=1
      DO WHILE (N.LT.4096 .AND. TEXT(N).NE.C_NULL_CHAR)
        N=N+1
      END DO
      WRITE(*,*) 'contact element ', JELEM, ': code ', CODE, ': ',
     1 TEXT(1:N-1)
      END SUBROUTINE

C     Opens the contact of an element.
      SUBROUTINE RAILSPRING_OPEN(JELEM, MU, AT, FORCES)
      INTEGER, INTENT(IN) :: JELEM
      DOUBLE PRECISION, INTENT(IN) :: MU
      TYPE(RMOTIONS), INTENT(IN) :: AT
      TYPE(RFORCES), INTENT(OUT) :: FORCES
      TYPE(C_PTR) :: ELEMENT
      CHARACTER(LEN=4096) :: PATH
      DOUBLE PRECISION :: COEFFICIENT
      INTEGER :: LENGTH, CODE
      CALL GET_ENVIRONMENT_VARIABLE('RAILSPRING_ELEMENT', PATH, LENGTH)
      COEFFICIENT=MU
      IF (MU.LT.0.D0) COEFFICIENT=IEEE_VALUE(MU, IEEE_QUIET_NAN)
      CODE=RELEMENT_OPEN(PATH(1:LENGTH)//C_NULL_CHAR, ELEMENT)
      IF (CODE.EQ.0) THEN
        CODE=RCONTACT_NEW(ELEMENT, COEFFICIENT, CONTACT(JELEM))
        CALL RELEMENT_FREE(ELEMENT)
      END IF
      IF (CODE.EQ.0) CODE=RCONTACT_START(CONTACT(JELEM), AT, FORCES)
      IF (CODE.NE.0) THEN
        CALL RAILSPRING_REPORT(JELEM, CODE)
        CALL XIT
      END IF
      END SUBROUTINE
      END MODULE

      SUBROUTINE UEL(RHS,AMATRX,SVARS,ENERGY,NDOFEL,NRHS,NSVARS,
     1 PROPS,NPROPS,COORDS,MCRD,NNODE,U,DU,V,A,JTYPE,TIME,DTIME,
     2 KSTEP,KINC,JELEM,PARAMS,NDLOAD,JDLTYP,ADLMAG,PREDEF,NPREDF,
     3 LFLAGS,MLVARX,DDLMAG,MDLOAD,PNEWDT,JPROPS,NJPROP,PERIOD)
      USE RAILSPRING_ABAQUS
      IMPLICIT NONE
      INTEGER NDOFEL,NRHS,NSVARS,NPROPS,MCRD,NNODE,JTYPE,KSTEP,KINC,
     1 JELEM,NDLOAD,NPREDF,MLVARX,MDLOAD,NJPROP,JDLTYP(MDLOAD,*),
     2 LFLAGS(*),JPROPS(*)
      DOUBLE PRECISION RHS(MLVARX,*),AMATRX(NDOFEL,NDOFEL),SVARS(*),
     1 ENERGY(8),PROPS(*),COORDS(MCRD,NNODE),U(NDOFEL),DU(MLVARX,*),
     2 V(NDOFEL),A(NDOFEL),TIME(2),DTIME,PARAMS(*),ADLMAG(MDLOAD,*),
     3 PREDEF(2,NPREDF,NNODE),DDLMAG(MDLOAD,*),PNEWDT,PERIOD
      TYPE(RMOTIONS) :: AT
      TYPE(RFORCES) :: FORCES
      DOUBLE PRECISION :: ALPHA, FORCE(6)
      INTEGER :: I, K, CODE
      LOGICAL :: DYNAMIC

      IF (JELEM.GT.MOST .OR. NSVARS.LT.20 .OR. NPROPS.LT.3 .OR.
     1 NDOFEL.NE.6) THEN
        WRITE(*,*) 'contact element ', JELEM, ': wrong dimensions'
        CALL XIT
      END IF
      DO I=1,NDOFEL
        RHS(I,1)=0.D0
        DO K=1,NDOFEL
          AMATRX(K,I)=0.D0
        END DO
      END DO
C     The element has neither damping nor mass.
      IF (LFLAGS(3).EQ.3 .OR. LFLAGS(3).EQ.4) RETURN
      IF (.NOT.C_ASSOCIATED(CONTACT(JELEM))) THEN
        IF (SVARS(1).GT.0.5D0) THEN
          WRITE(*,*) 'contact element ', JELEM, ': no restart'
          CALL XIT
        END IF
        AT%RIM=U(1:3)-DU(1:3,1)
        AT%SECTION=U(4:6)-DU(4:6,1)
        AT%PLACE=PROPS(1)+PROPS(2)*(TIME(2)-DTIME)
        IF (PROPS(2).EQ.0.D0) AT%PLACE=PROPS(1)
        CALL RAILSPRING_OPEN(JELEM, PROPS(3), AT, FORCES)
      END IF

C     In a new increment it takes what the last one converged to.
      I=NINT(SVARS(1))
      IF (I.EQ.TAKEN(JELEM)+1 .AND.
     1 (KSTEP.NE.STEP(JELEM) .OR. KINC.NE.INC(JELEM))) THEN
        AT%RIM=SVARS(2:4)
        AT%SECTION=SVARS(5:7)
        AT%PLACE=SVARS(8)
        CODE=RCONTACT_EVALUATE(CONTACT(JELEM), AT, FORCES)
        IF (CODE.EQ.0) CODE=RCONTACT_COMMIT(CONTACT(JELEM))
        IF (CODE.NE.0) THEN
          CALL RAILSPRING_REPORT(JELEM, CODE)
          CALL XIT
        END IF
        TAKEN(JELEM)=I
      ELSE IF (I.NE.TAKEN(JELEM)) THEN
        WRITE(*,*) 'contact element ', JELEM, ': lost an increment'
        CALL XIT
      END IF
      STEP(JELEM)=KSTEP
      INC(JELEM)=KINC

      AT%RIM=U(1:3)
      AT%SECTION=U(4:6)
      AT%PLACE=PROPS(1)+PROPS(2)*TIME(2)
      CODE=RCONTACT_EVALUATE(CONTACT(JELEM), AT, FORCES)
      IF (CODE.NE.0) THEN
        CALL RAILSPRING_REPORT(JELEM, CODE)
        IF (CODE.EQ.4) CALL XIT
        PNEWDT=MIN(PNEWDT, 0.25D0)
        RETURN
      END IF
      FORCE(1:3)=FORCES%RIM
      FORCE(4:6)=FORCES%SECTION

C     Dynamic steps average forces (Hilber, Hughes and Taylor).
      DYNAMIC=LFLAGS(1).EQ.11 .OR. LFLAGS(1).EQ.12
      ALPHA=0.D0
      IF (DYNAMIC) ALPHA=PARAMS(1)
      IF (LFLAGS(3).EQ.6) ALPHA=0.D0
      DO I=1,6
        RHS(I,1)=(1.D0+ALPHA)*FORCE(I)-ALPHA*SVARS(8+I)
        IF (LFLAGS(3).EQ.5) RHS(I,1)=(1.D0+ALPHA)*FORCE(I)
     1   -0.5D0*ALPHA*(SVARS(8+I)+SVARS(14+I))
        IF (LFLAGS(3).LE.2) THEN
          DO K=1,6
            AMATRX(I,K)=-(1.D0+ALPHA)*FORCES%TANGENT(K,I)
          END DO
        END IF
      END DO
      IF (LFLAGS(3).EQ.1) THEN
        SVARS(1)=DBLE(TAKEN(JELEM)+1)
        SVARS(2:4)=AT%RIM
        SVARS(5:7)=AT%SECTION
        SVARS(8)=AT%PLACE
        SVARS(15:20)=SVARS(9:14)
        SVARS(9:14)=FORCE
      END IF
      END
