(** Values at states in exact numbers: numbers are rational, and angles are [2 atan t] with a rational [t], so that their sines and
    cosines are. [value_ok] says that what is calculated is the value, and that there is one. *)

Require Import Reals QArith Qreals Lra Lia.
Require Export ZArith.
From Palmistry Require Import Lie Check.
Local Open Scope R_scope.

(** A coordinate of a state: the number [above / below], or the angle [2 atan (above / below)]. *)
Inductive coordinate := Number (above : Z) (below : positive) | Angle (above : Z) (below : positive).
Arguments Number above%Z below%positive.
Arguments Angle above%Z below%positive.
Notation place := (list (term * coordinate)).
(** Where there is no variable. *)
Definition anywhere : place := [].
Fixpoint at_place (p : place) (v : positive) : option coordinate :=
  match p with [] => None | (y, c) :: more => if same_variable y v then Some c else at_place more v end.
Definition coordinate_value (c : coordinate) : R := match c with Number a b => Q2R (a # b) | Angle a b => 2 * atan (Q2R (a # b)) end.
(** The state; what is not named is zero. *)
Definition state_at (p : place) : state :=
  fun v => match at_place p v with Some c => coordinate_value c | None => 0 end.

Definition circle_point (t : Q) : Q * Q := (Qred ((2 * t) / (1 + t * t)), Qred ((1 - t * t) / (1 + t * t)))%Q.

Definition turned_to (s c : Q) : Q * Q := (s, c).
Definition turn (a b : Q * Q) : Q * Q :=
  (Qred (fst a * snd b + snd a * fst b), Qred (snd a * snd b - fst a * fst b))%Q.
Fixpoint turns (n : nat) (one : Q * Q) : Q * Q := match n with O => (0, 1)%Q | S n => turn one (turns n one) end.
Definition quarter_point (n : Z) : Q * Q :=
  match (n mod 4)%Z with 0%Z => (0, 1)%Q | 1%Z => (1, 0)%Q | 2%Z => (0, - (1))%Q | _ => (- (1), 0)%Q end.

(** Sine and cosine of an angle. *)
Fixpoint circular (p : place) (e : term) : option (Q * Q) :=
  match quarters e with
  | Some n => Some (quarter_point n)
  | None =>
      match e with
      | Mul (Cst z) a =>
          if (Z.abs z <=? most)%Z then
            option_map (fun one => let m := turns (Z.abs_nat z) one in if (z <? 0)%Z then turned_to (- fst m) (snd m) else m)
              (circular p a)
          else None
      | Var v => match at_place p v with Some (Angle a b) => Some (circle_point (a # b)) | _ => None end
      | Opp a => option_map (fun a => turned_to (- fst a) (snd a)) (circular p a)
      | Add a b => both turn (circular p a) (circular p b)
      | Sub a b => both (fun a b => turn a (turned_to (- fst b) (snd b))) (circular p a) (circular p b)
      | _ => None
      end
  end.

(** An angle that has a value at every state. *)
Fixpoint is_plain (e : term) : bool :=
  match e with
  | Cst _ | Pi | Var _ => true
  | Add a b | Sub a b | Mul a b => is_plain a && is_plain b
  | Opp a => is_plain a
  | Inv (Cst z) => negb (Z.eqb z 0)
  | _ => false
  end.

Definition lift2 (f : Q -> Q -> Q) (a b : option Q) :=
  match a, b with Some a, Some b => Some (Qred (f a b)) | _, _ => None end.
Fixpoint Qpow (a : Q) (n : nat) : Q := match n with O => 1%Q | S n => Qred (a * Qpow a n) end.

Fixpoint value (p : place) (e : term) : option Q :=
  match e with
  | Cst z => Some (inject_Z z)
  | Var v => match at_place p v with Some (Number a b) => Some (a # b) | None => Some 0%Q | _ => None end
  | Add a b => lift2 Qplus (value p a) (value p b)
  | Sub a b => lift2 Qminus (value p a) (value p b)
  | Mul a b => lift2 Qmult (value p a) (value p b)
  | Opp a => option_map Qopp (value p a)
  | Inv a => match value p a with Some a => if Qeq_bool a 0 then None else Some (/ a)%Q | None => None end
  | Pow a n => option_map (fun a => Qpow a n) (value p a)
  | Sin a => if is_plain a then option_map fst (circular p a) else None
  | Cos a => if is_plain a then option_map snd (circular p a) else None
  | _ => None
  end.

Local Opaque Qred.
Lemma Qred_R a : Q2R (Qred a) = Q2R a.
Proof. apply Qeq_eqR, Qred_correct. Qed.
Lemma Q2R_Z z : Q2R (inject_Z z) = IZR z.
Proof. unfold Q2R, inject_Z. cbn. field. Qed.
Lemma Q2R_0' : Q2R 0 = 0. Proof. exact (Q2R_Z 0). Qed.
Lemma Q2R_1' : Q2R 1 = 1. Proof. exact (Q2R_Z 1). Qed.

Lemma circle_point_ok t :
  sin (2 * atan (Q2R t)) = Q2R (fst (circle_point t)) /\ cos (2 * atan (Q2R t)) = Q2R (snd (circle_point t)).
Proof.
  assert (N : ~ (1 + t * t == 0)%Q).
  { intros E. apply Qeq_eqR in E. rewrite Q2R_plus, Q2R_mult, Q2R_1', Q2R_0' in E. nra. }
  cbn [circle_point fst snd]. rewrite !Qred_R, !Q2R_div, Q2R_minus, Q2R_plus, !Q2R_mult, Q2R_1' by auto.
  replace (Q2R 2) with 2 by (symmetry; exact (Q2R_Z 2)). set (u := Q2R t).
  assert (P : 0 < 1 + u ^ 2) by nra.
  pose proof (sqrt_lt_R0 _ P) as S0. pose proof (sqrt_sqrt _ (Rlt_le _ _ P)) as S.
  rewrite sin_2a, cos_2a_cos, cos_atan, sin_atan. unfold Rsqr. replace (u * u) with (u ^ 2) by ring.
  set (r := sqrt (1 + u ^ 2)) in *. replace (1 + u ^ 2) with (r * r).
  replace (u ^ 2) with (r * r - 1) by lra. split; field; lra.
Qed.

Definition points_to (a : Q * Q) (angle : R) := sin angle = Q2R (fst a) /\ cos angle = Q2R (snd a).
Lemma back_ok a y : points_to a y -> points_to (turned_to (- fst a) (snd a)) (- y).
Proof. intros [S C]. split; cbn; [rewrite sin_neg, S, Q2R_opp|rewrite cos_neg, C]; reflexivity. Qed.
Lemma turn_ok a b y z : points_to a y -> points_to b z -> points_to (turn a b) (y + z).
Proof.
  intros [S C] [T K]. unfold points_to, turn; cbn [fst snd].
  rewrite !Qred_R, Q2R_plus, Q2R_minus, !Q2R_mult, sin_plus, cos_plus, S, C, T, K. auto.
Qed.
Lemma turns_ok a y n : points_to a y -> points_to (turns n a) (INR n * y).
Proof.
  intros H. induction n; cbn [turns].
  - unfold points_to; cbn [fst snd INR]. rewrite Rmult_0_l, sin_0, cos_0, Q2R_0', Q2R_1'. auto.
  - rewrite S_INR. replace ((INR n + 1) * y) with (y + INR n * y) by ring. apply turn_ok; auto.
Qed.
Lemma quarter_ok n : points_to (quarter_point n) (IZR n * (PI / 2)).
Proof.
  destruct (of_quarters_ok [] n) as [S C]. unfold points_to. rewrite <- S, <- C. unfold of_quarters, quarter_point.
  pose proof (Z.mod_pos_bound n 4 ltac:(lia)).
  assert (n mod 4 = 0 \/ n mod 4 = 1 \/ n mod 4 = 2 \/ n mod 4 = 3)%Z as [E|[E|[E|E]]] by lia; rewrite E;
    cbn [fst snd Ring_polynom.Pphi]; rewrite ?Q2R_opp, ?Q2R_0', ?Q2R_1'; split; lra.
Qed.
Lemma circular_ok p e : forall a, circular p e = Some a -> defined (state_at p) e -> points_to a (eval (state_at p) e).
Proof.
  assert (by_quarters : forall e n a, quarters e = Some n -> Some (quarter_point n) = Some a ->
    points_to a (eval (state_at p) e)).
  { intros b n a Q [= <-]. rewrite (quarters_ok (state_at p) b n Q). apply quarter_ok. }
  induction e; intros q; cbn [circular];
    (match goal with |- context [quarters ?e] => destruct (quarters e) eqn:Q; [intros H _; apply (by_quarters _ _ _ Q H)|] end);
    try discriminate; cbn [defined eval].
  - unfold state_at. destruct (at_place p v) as [[]|]; try discriminate. intros [= <-] _. exact (circle_point_ok (above # below)).
  - destruct (circular p e1), (circular p e2); try discriminate. intros [= <-] [D E]. apply turn_ok; auto.
  - destruct (circular p e1), (circular p e2); try discriminate. intros [= <-] [D E]. unfold Rminus.
    apply turn_ok; [|apply back_ok]; auto.
  - destruct e1; try discriminate. destruct (Z.abs z <=? most)%Z; [|discriminate].
    destruct (circular p e2) as [a|]; [|discriminate]. intros [= <-] [_ D]. specialize (IHe2 a eq_refl D).
    pose proof (turns_ok _ _ (Z.abs_nat z) IHe2) as M. cbn [eval].
    rewrite INR_IZR_INZ, Zabs2Nat.id_abs in M. destruct (z <? 0)%Z eqn:N.
    + apply Z.ltb_lt in N. rewrite Z.abs_neq, opp_IZR in M by lia.
      replace (IZR z * eval (state_at p) e2) with (- (- IZR z * eval (state_at p) e2)) by ring. apply back_ok, M.
    + apply Z.ltb_ge in N. rewrite Z.abs_eq in M by lia. exact M.
  - destruct (circular p e) as [a|]; [|discriminate]. intros [= <-] D. apply back_ok; auto.
Qed.
Lemma is_plain_ok x e : is_plain e = true -> defined x e.
Proof.
  induction e; cbn [is_plain defined]; try discriminate; auto;
    try (intros H; apply Bool.andb_true_iff in H; tauto).
  destruct e; try discriminate. intros H. split; [exact I|]. cbn. apply not_0_IZR. intros ->. discriminate.
Qed.

Theorem value_ok p e : forall a, value p e = Some a -> defined (state_at p) e /\ eval (state_at p) e = Q2R a.
Proof.
  assert (two : forall f g x y, (forall a b, Q2R (f a b) = g (Q2R a) (Q2R b)) ->
    (forall a, value p x = Some a -> defined (state_at p) x /\ eval (state_at p) x = Q2R a) ->
    (forall a, value p y = Some a -> defined (state_at p) y /\ eval (state_at p) y = Q2R a) ->
    forall a, lift2 f (value p x) (value p y) = Some a ->
    (defined (state_at p) x /\ defined (state_at p) y) /\ g (eval (state_at p) x) (eval (state_at p) y) = Q2R a).
  { intros f g x y H X Y a. destruct (value p x) as [b|], (value p y) as [c|]; try discriminate. intros [= <-].
    destruct (X b eq_refl) as [D ->], (Y c eq_refl) as [E ->]. rewrite Qred_R, H. auto. }
  induction e; cbn [value]; intros r H; try discriminate.
  - injection H as <-. split; [exact I|]. symmetry. apply Q2R_Z.
  - split; [exact I|]. cbn [eval]. unfold state_at. destruct (at_place p v) as [[]|]; try discriminate;
      injection H as <-; [reflexivity|symmetry; apply Q2R_0'].
  - apply (two _ _ e1 e2 Q2R_plus IHe1 IHe2 _ H).
  - apply (two _ _ e1 e2 Q2R_minus IHe1 IHe2 _ H).
  - apply (two _ _ e1 e2 Q2R_mult IHe1 IHe2 _ H).
  - destruct (value p e) as [b|]; [|discriminate]. injection H as <-. destruct (IHe b eq_refl) as [D V].
    cbn [defined eval]. rewrite V, Q2R_opp. auto.
  - destruct (value p e) as [b|]; [|discriminate]. destruct (Qeq_bool b 0) eqn:Z; [discriminate|]. injection H as <-.
    destruct (IHe b eq_refl) as [D V]. apply Qeq_bool_neq in Z. cbn [defined eval]. rewrite V, Q2R_inv by exact Z.
    split; [split; [exact D|]|reflexivity]. intros E. apply Z, eqR_Qeq. rewrite E. symmetry. apply Q2R_0'.
  - destruct (value p e) as [b|]; [|discriminate]. injection H as <-. destruct (IHe b eq_refl) as [D V].
    cbn [defined eval]. split; [exact D|]. rewrite V. clear. induction n; cbn [Qpow pow]; [symmetry; apply Q2R_1'|].
    rewrite Qred_R, Q2R_mult, IHn. reflexivity.
  - destruct (is_plain e) eqn:P; [|discriminate]. apply (is_plain_ok (state_at p)) in P.
    destruct (circular p e) as [a|] eqn:E; [|discriminate]. injection H as <-.
    destruct (circular_ok p e a E P) as [S _]. cbn [defined eval]. auto.
  - destruct (is_plain e) eqn:P; [|discriminate]. apply (is_plain_ok (state_at p)) in P.
    destruct (circular p e) as [a|] eqn:E; [|discriminate]. injection H as <-.
    destruct (circular_ok p e a E P) as [_ C]. cbn [defined eval]. auto.
Qed.

(** ** What is shown at one state *)

(** Whether a state is shown to meet a condition. *)
Definition met (p : place) (c : condition) : bool :=
  let compare a b (ok : Q -> Q -> bool) := match value p a, value p b with Some a, Some b => ok a b | _, _ => false end in
  match c with
  | Equal a b => compare a b Qeq_bool
  | Differ a b => compare a b (fun a b => negb (Qeq_bool a b))
  | Less a b => compare a b (fun a b => negb (Qle_bool b a))
  | AtMost a b => compare a b Qle_bool
  end.
Lemma Qeq_bool_R a b : Qeq_bool a b = true -> Q2R a = Q2R b.
Proof. intros H. apply Qeq_eqR, Qeq_bool_eq, H. Qed.
Lemma Qneq_bool_R a b : negb (Qeq_bool a b) = true -> Q2R a <> Q2R b.
Proof. intros H E. apply eqR_Qeq, Qeq_bool_iff in E. rewrite E in H. discriminate. Qed.
Lemma met_ok p c : met p c = true -> meets (state_at p) c.
Proof.
  destruct c as [a b|a b|a b|a b]; cbn [met meets]; destruct (value p a) as [x|] eqn:A; try discriminate;
    destruct (value p b) as [y|] eqn:B; try discriminate; destruct (value_ok p a x A) as [D ->], (value_ok p b y B) as [E ->];
    intros H; repeat split; auto.
  - apply Qeq_bool_R, H.
  - apply Qneq_bool_R, H.
  - apply Qlt_Rlt. apply Bool.negb_true_iff in H. apply Qnot_le_lt. intros L. apply Qle_bool_iff in L. congruence.
  - apply Qle_Rle, Qle_bool_iff, H.
Qed.
Definition all_met (p : place) (conditions : list condition) : bool := forallb (met p) conditions.
Lemma all_met_ok p conditions : all_met p conditions = true -> Forall (meets (state_at p)) conditions.
Proof.
  intros H. apply Forall_forall. intros c I. apply met_ok. eapply forallb_forall in H; eauto.
Qed.

(** Two terms differ at a state that meets the conditions, and at which both have a value. *)
Definition refuted (conditions : list condition) (a b : term) :=
  exists x, Forall (meets x) conditions /\ defined x a /\ defined x b /\ eval x a <> eval x b.
(** There is a state that meets the conditions, and at which both have a value. *)
Definition is_about_something (conditions : list condition) (a b : term) :=
  exists x, Forall (meets x) conditions /\ defined x a /\ defined x b.

Theorem refuted_correct p conditions a b :
  all_met p conditions && met p (Differ a b) = true -> refuted conditions a b.
Proof.
  intros H. apply Bool.andb_true_iff in H. destruct H as [C D]. exists (state_at p).
  split; [apply all_met_ok, C|]. exact (met_ok _ _ D).
Qed.
Theorem about_correct p conditions a b :
  all_met p conditions &&
    match value p a, value p b with Some _, Some _ => true | _, _ => false end = true ->
  is_about_something conditions a b.
Proof.
  intros H. apply Bool.andb_true_iff in H. destruct H as [C D]. exists (state_at p). split; [apply all_met_ok, C|].
  destruct (value p a) eqn:A; [|discriminate]. destruct (value p b) eqn:B; [|discriminate].
  apply value_ok in A, B. tauto.
Qed.

Definition matrices_are_about_something conditions (m n : matrix) := Forall2 (Forall2 (is_about_something conditions)) m n.
Theorem about_matrices_correct p conditions m n :
  for_all (for_all (fun a b => all_met p conditions &&
    match value p a, value p b with Some _, Some _ => true | _, _ => false end)) m n = true ->
  matrices_are_about_something conditions m n.
Proof. apply for_all_ok, for_all_ok, about_correct. Qed.

(** The proofs of one line. *)
Ltac differs_at p := apply (refuted_correct p); vm_cast_no_check (eq_refl true).
Ltac defined_at p := first [ apply (about_correct p) | apply (about_matrices_correct p) ]; vm_cast_no_check (eq_refl true).
