(** A decision procedure for identities of terms, proved correct: both sides are brought to one fraction of polynomials in variables,
    sines, cosines and other functions, whose denominators are products of factors that do not vanish where the sides are defined;
    squares of sines and of roots are replaced while multiplying. [same_correct] and its kin are what theorems rest on. *)

Require Import Reals Lra Lia ZArith PArith NArith List Bool.
Require Import Ring_theory Ring_polynom Field_theory RealField BinList InitialRing.
From Palmistry Require Import Lie.
Import ListNotations.
Local Open Scope R_scope.

(** * Polynomials with integer coefficients, as Coq's own ring tactic has them *)

Notation poly := (Pol Z).
Notation zero := (Pc 0%Z).
Notation one := (Pc 1%Z).
Definition padd : poly -> poly -> poly := Padd 0%Z Z.add Zeq_bool.
Definition psub : poly -> poly -> poly := Psub 0%Z Z.add Z.sub Z.opp Zeq_bool.
Definition popp : poly -> poly := Popp Z.opp.
Definition product : poly -> poly -> poly := Pmul 0%Z 1%Z Z.add Z.mul Zeq_bool.
Definition peq : poly -> poly -> bool := Peq Zeq_bool.
Notation value l p := (Pphi 0 Rplus Rmult IZR l p).

Definition ring_of_R := F2AF (Eqsth R) (Eq_ext Rplus Rmult Ropp) Rfield.
Definition almost := AF_AR ring_of_R.
Definition extends := Eq_ext Rplus Rmult Ropp.

Lemma padd_ok l p q : value l (padd p q) = value l p + value l q.
Proof. apply (Padd_ok (Eqsth R) extends almost R_rm). Qed.
Lemma psub_ok l p q : value l (psub p q) = value l p - value l q.
Proof. apply (Psub_ok (Eqsth R) extends almost R_rm). Qed.
Lemma popp_ok l p : value l (popp p) = - value l p.
Proof. apply (Popp_ok (Eqsth R) extends almost R_rm). Qed.
Lemma product_ok l p q : value l (product p q) = value l p * value l q.
Proof. apply (Pmul_ok (Eqsth R) extends almost R_rm). Qed.
Lemma peq_ok l p q : peq p q = true -> value l p = value l q.
Proof. intros H. exact (Peq_ok (Eqsth R) extends R_rm p q H l). Qed.

(** ** Atoms: what polynomials are of *)

Definition term_eq_dec (a b : term) : {a = b} + {a <> b}.
Proof. decide equality; try apply Z.eq_dec; try apply Pos.eq_dec; apply Nat.eq_dec. Defined.

Fixpoint place (e : term) (atoms : list term) : option positive :=
  match atoms with
  | [] => None
  | a :: more => if term_eq_dec e a then Some 1%positive else option_map Pos.succ (place e more)
  end.
Lemma nth_succ p a (l : list R) : BinList.nth 0 (Pos.succ p) (a :: l) = BinList.nth 0 p l.
Proof.
  change (a :: l) with (tl (a :: a :: l)). rewrite nth_jump, jump_succ. cbn [jump].
  rewrite jump_tl. cbn [tl]. symmetry. exact (nth_jump 0 p (a :: l)).
Qed.
Lemma place_ok x e atoms : forall p, place e atoms = Some p -> BinList.nth 0 p (map (eval x) atoms) = eval x e.
Proof.
  induction atoms as [|a more IH]; intros p; cbn [place map]; [discriminate|].
  destruct (term_eq_dec e a) as [->|_]; [intros [= <-]; reflexivity|].
  destruct (place e more) as [q|]; [|discriminate]. intros [= <-]. rewrite nth_succ. auto.
Qed.

(** What is no atom of the list cannot be decided, and is nothing. *)
Definition atom (atoms : list term) (e : term) : option poly :=
  option_map (fun p => mk_X 0%Z 1%Z p) (place e atoms).
Lemma atom_ok x atoms e p : atom atoms e = Some p -> value (map (eval x) atoms) p = eval x e.
Proof.
  unfold atom. destruct (place e atoms) as [q|] eqn:E; [|discriminate]. intros [= <-].
  rewrite <- (mkX_ok (Eqsth R) extends almost R_rm). apply place_ok, E.
Qed.

Definition both {A B C} (f : A -> B -> C) (a : option A) (b : option B) : option C :=
  match a, b with Some a, Some b => Some (f a b) | _, _ => None end.

(** * Sines and cosines of sums, multiples and quarter turns *)

(** The number of quarter turns that an angle is. *)
Fixpoint quarters (e : term) : option Z :=
  match e with
  | Cst 0 => Some 0%Z
  | Pi => Some 2%Z
  | Opp a => option_map Z.opp (quarters a)
  | Mul (Cst z) a => option_map (Z.mul z) (quarters a)
  | Mul a (Inv (Cst 2)) =>
      match quarters a with Some n => if Z.even n then Some (Z.div2 n) else None | None => None end
  | Mul _ (Cst 0) => Some 0%Z
  | _ => None
  end.
Lemma quarters_ok x e : forall n, quarters e = Some n -> eval x e = IZR n * (PI / 2).
Proof.
  assert (half : forall a n, eval x a = IZR n * (PI / 2) -> Z.even n = true ->
    eval x a * / 2 = IZR (Z.div2 n) * (PI / 2)).
  { intros a n H E. apply Z.even_spec in E. destruct E as [k ->]. rewrite H.
    replace (Z.div2 (2 * k)) with k by (rewrite Z.div2_div, Z.mul_comm, Z.div_mul; lia).
    rewrite mult_IZR. lra. }
  induction e; intros k; cbn [quarters]; try discriminate.
  - destruct z; try discriminate. intros [= <-]. cbn. lra.
  - intros [= <-]. cbn. lra.
  - assert (right : match e2 with Inv (Cst 2) => match quarters e1 with Some n => if Z.even n then Some (Z.div2 n) else None | None => None end
      | Cst 0 => Some 0%Z | _ => None end = Some k -> eval x (Mul e1 e2) = IZR k * (PI / 2)).
    { destruct e2; try discriminate.
      { destruct z; try discriminate. intros [= <-]. cbn. ring. }
      destruct e2; try discriminate. destruct z; try discriminate.
      destruct p; try discriminate. destruct p; try discriminate.
      destruct (quarters e1) as [m|]; [|discriminate]. destruct (Z.even m) eqn:E; [|discriminate].
      intros [= <-]. cbn [eval]. apply half; auto. }
    destruct e1; try exact right.
    destruct (quarters e2) as [m|]; [|discriminate]. intros [= <-]. cbn [eval].
    rewrite (IHe2 m), mult_IZR by auto. ring.
  - destruct (quarters e) as [m|]; [|discriminate]. intros [= <-]. cbn [eval].
    rewrite (IHe m), opp_IZR by auto. ring.
Qed.

(** Sine and cosine of so many quarter turns. *)
Definition of_quarters (n : Z) : poly * poly :=
  match (n mod 4)%Z with
  | 0%Z => (zero, one) | 1%Z => (one, zero) | 2%Z => (zero, Pc (-1)%Z) | _ => (Pc (-1)%Z, zero)
  end.
Lemma whole_turns a k : sin (a + IZR k * (2 * PI)) = sin a /\ cos (a + IZR k * (2 * PI)) = cos a.
Proof.
  assert (H : forall b n, sin (b + INR n * (2 * PI)) = sin b /\ cos (b + INR n * (2 * PI)) = cos b).
  { intros b n. split; [rewrite <- (sin_period b n)|rewrite <- (cos_period b n)]; f_equal; ring. }
  destruct (Z_le_dec 0 k).
  - replace (IZR k) with (INR (Z.to_nat k)) by (rewrite INR_IZR_INZ, Z2Nat.id; auto). apply H.
  - destruct (H (a + IZR k * (2 * PI)) (Z.to_nat (- k))) as [A B].
    rewrite <- A, <- B. split; f_equal; rewrite INR_IZR_INZ, Z2Nat.id, opp_IZR by lia; ring.
Qed.
Lemma of_quarters_ok l n :
  value l (fst (of_quarters n)) = sin (IZR n * (PI / 2)) /\ value l (snd (of_quarters n)) = cos (IZR n * (PI / 2)).
Proof.
  pose proof (Z.mod_pos_bound n 4 ltac:(lia)). pose proof (Z.div_mod n 4 ltac:(lia)) as D.
  unfold of_quarters. set (r := (n mod 4)%Z) in *. set (k := (n / 4)%Z) in *.
  replace (IZR n * (PI / 2)) with (IZR r * (PI / 2) + IZR k * (2 * PI))
    by (rewrite D, plus_IZR, mult_IZR; lra).
  destruct (whole_turns (IZR r * (PI / 2)) k) as [-> ->].
  assert (r = 0 \/ r = 1 \/ r = 2 \/ r = 3)%Z as [E|[E|[E|E]]] by lia; rewrite E; cbn [fst snd Pphi].
  - rewrite Rmult_0_l, sin_0, cos_0. auto.
  - rewrite Rmult_1_l, sin_PI2, cos_PI2. auto.
  - replace (2 * (PI / 2)) with PI by lra. rewrite sin_PI, cos_PI. auto.
  - replace (3 * (PI / 2)) with (PI + PI / 2) by lra.
    rewrite sin_plus, cos_plus, sin_PI, cos_PI, sin_PI2, cos_PI2. split; cbn; lra.
Qed.

Notation sc := (poly * poly)%type.
Definition turned (a b : sc) : sc :=
  (padd (product (fst a) (snd b)) (product (snd a) (fst b)),
   psub (product (snd a) (snd b)) (product (fst a) (fst b))).
Definition turned_back (a : sc) : sc := (popp (fst a), snd a).
Fixpoint multiple (n : nat) (a : sc) : sc := match n with O => (zero, one) | S n => turned a (multiple n a) end.
Definition is_of (l : list R) (a : sc) (angle : R) := value l (fst a) = sin angle /\ value l (snd a) = cos angle.
Lemma turned_ok l a b s t : is_of l a s -> is_of l b t -> is_of l (turned a b) (s + t).
Proof.
  intros [A B] [C D]. unfold is_of, turned; cbn [fst snd].
  rewrite padd_ok, psub_ok, !product_ok, A, B, C, D, sin_plus, cos_plus. auto.
Qed.
Lemma turned_back_ok l a s : is_of l a s -> is_of l (turned_back a) (- s).
Proof. intros [A B]. unfold is_of, turned_back; cbn [fst snd]. rewrite popp_ok, A, B, sin_neg, cos_neg. auto. Qed.
Lemma multiple_ok l a s n : is_of l a s -> is_of l (multiple n a) (INR n * s).
Proof.
  intros H. induction n; cbn [multiple].
  - unfold is_of; cbn. rewrite Rmult_0_l, sin_0, cos_0. auto.
  - rewrite S_INR. replace ((INR n + 1) * s) with (s + INR n * s) by ring. apply turned_ok; auto.
Qed.

(** No greater multiple of an angle is expanded. *)
Definition most := 12%Z.
Fixpoint sine_and_cosine (atoms : list term) (e : term) : option sc :=
  match quarters e with
  | Some n => Some (of_quarters n)
  | None =>
      match e with
      | Add a b => both turned (sine_and_cosine atoms a) (sine_and_cosine atoms b)
      | Sub a b => both (fun a b => turned a (turned_back b)) (sine_and_cosine atoms a) (sine_and_cosine atoms b)
      | Opp a => option_map turned_back (sine_and_cosine atoms a)
      | Mul (Cst z) a =>
          if (Z.abs z <=? most)%Z then
            option_map (fun a => let m := multiple (Z.abs_nat z) a in if (z <? 0)%Z then turned_back m else m)
              (sine_and_cosine atoms a)
          else both pair (atom atoms (Sin e)) (atom atoms (Cos e))
      | _ => both pair (atom atoms (Sin e)) (atom atoms (Cos e))
      end
  end.
Lemma sine_and_cosine_ok x atoms e : forall a, sine_and_cosine atoms e = Some a -> is_of (map (eval x) atoms) a (eval x e).
Proof.
  assert (whole : forall e a, both pair (atom atoms (Sin e)) (atom atoms (Cos e)) = Some a ->
    is_of (map (eval x) atoms) a (eval x e)).
  { intros b a. destruct (atom atoms (Sin b)) eqn:S, (atom atoms (Cos b)) eqn:C; try discriminate. intros [= <-].
    apply (atom_ok x) in S, C. split; assumption. }
  assert (by_quarters : forall e n a, quarters e = Some n -> Some (of_quarters n) = Some a ->
    is_of (map (eval x) atoms) a (eval x e)).
  { intros b n a Q [= <-]. unfold is_of. rewrite (quarters_ok x b n Q). apply of_quarters_ok. }
  induction e; intros q; cbn [sine_and_cosine];
    (match goal with |- context [quarters ?e] => destruct (quarters e) eqn:Q; [apply (by_quarters _ _ _ Q)|] end);
    try apply whole.
  - destruct (sine_and_cosine atoms e1), (sine_and_cosine atoms e2); try discriminate. intros [= <-].
    cbn [eval]. apply turned_ok; auto.
  - destruct (sine_and_cosine atoms e1), (sine_and_cosine atoms e2); try discriminate. intros [= <-].
    cbn [eval]. unfold Rminus. apply turned_ok; [|apply turned_back_ok]; auto.
  - destruct e1; try apply whole. destruct (Z.abs z <=? most)%Z; [|apply whole].
    destruct (sine_and_cosine atoms e2) as [a|]; [|discriminate]. intros [= <-]. cbn [eval].
    specialize (IHe2 a eq_refl). pose proof (multiple_ok _ _ _ (Z.abs_nat z) IHe2) as M.
    rewrite INR_IZR_INZ, Zabs2Nat.id_abs in M. destruct (z <? 0)%Z eqn:N.
    + apply Z.ltb_lt in N. rewrite Z.abs_neq, opp_IZR in M by lia.
      replace (IZR z * eval x e2) with (- (- IZR z * eval x e2)) by ring. apply turned_back_ok, M.
    + apply Z.ltb_ge in N. rewrite Z.abs_eq in M by lia. exact M.
  - destruct (sine_and_cosine atoms e) as [a|]; [|discriminate]. intros [= <-]. cbn [eval]. apply turned_back_ok; auto.
Qed.

(** * Squares that are replaced: sin^2 = 1 - cos^2, and squares of roots of polynomials *)

Definition rules := list (Z * Mon * poly).
Definition reduce (r : rules) (p : poly) : poly :=
  PNSubstL 0%Z 1%Z Z.add Z.mul Zeq_bool (triv_div 0%Z 1%Z Zeq_bool) p r 99 99.
Notation hold r l := (MPcond 0 1 Rplus Rmult (@eq R) IZR r l).
Lemma reduce_ok r l p : hold r l -> value l (reduce r p) = value l p.
Proof.
  intros H. symmetry. apply (PNSubstL_ok (Eqsth R) extends almost R_rm (triv_div_th (Eqsth R) extends almost R_rm)), H.
Qed.

(** * Fractions whose denominators are products of powers *)

Notation factors := (list (poly * nat)).
Record fraction := { top : poly; bottom : factors }.
Definition over (l : list R) (b : factors) : R := fold_right (fun f r => value l (fst f) ^ snd f * r) 1 b.
Definition nonzero (l : list R) (b : factors) := Forall (fun f : poly * nat => value l (fst f) <> 0) b.
(** What a fraction stands for. *)
Definition means (l : list R) (f : fraction) (y : R) := nonzero l (bottom f) /\ y * over l (bottom f) = value l (top f).

Lemma over_app l a b : over l (a ++ b) = over l a * over l b.
Proof. unfold over. induction a as [|f a IH]; cbn [app fold_right]; [ring|]. rewrite IH. ring. Qed.
Lemma nonzero_app l a b : nonzero l a -> nonzero l b -> nonzero l (a ++ b).
Proof. intros; apply Forall_app; auto. Qed.
Lemma over_nonzero l b : nonzero l b -> over l b <> 0.
Proof.
  induction 1 as [|f b H _ IH]; cbn [over fold_right]; [lra|]. apply Rmult_integral_contrapositive_currified; [|exact IH].
  apply pow_nonzero, H.
Qed.

Fixpoint power (r : rules) (p : poly) (n : nat) : poly :=
  match n with O => one | S O => p | S n => reduce r (product p (power r p n)) end.
Lemma power_ok r l p n : hold r l -> value l (power r p n) = value l p ^ n.
Proof.
  intros H. induction n as [|[|n] IH]; [reflexivity|cbn; ring|].
  change (power r p (S (S n))) with (reduce r (product p (power r p (S n)))).
  rewrite reduce_ok, product_ok, IH by auto. reflexivity.
Qed.
Fixpoint expanded (r : rules) (b : factors) : poly :=
  match b with
  | [] => one
  | (_, O) :: b => expanded r b
  | (p, n) :: b => reduce r (product (power r p n) (expanded r b))
  end.
Lemma expanded_ok r l b : hold r l -> value l (expanded r b) = over l b.
Proof.
  intros H. induction b as [|[p n] b IH]; [reflexivity|]. unfold over in *. cbn [expanded fold_right fst snd].
  destruct n; [rewrite IH; cbn; ring|]. rewrite reduce_ok, product_ok, power_ok, IH by auto. reflexivity.
Qed.

(** A common multiple; that it is one is looked at when the factors of each are taken out of it. *)
Fixpoint raise (p : poly) (n : nat) (b : factors) : factors :=
  match b with
  | [] => [(p, n)]
  | (q, m) :: b => if peq p q then (q, Nat.max m n) :: b else (q, m) :: raise p n b
  end.
Definition common (a b : factors) : factors := fold_right (fun f => raise (fst f) (snd f)) a b.
Lemma common_nonzero l a b : nonzero l a -> nonzero l b -> nonzero l (common a b).
Proof.
  intros A. assert (one_more : forall p n c, value l p <> 0 -> nonzero l c -> nonzero l (raise p n c)).
  { intros p n c P. induction 1 as [|[q m] c Q H IH]; cbn [raise]; [constructor; auto; constructor|].
    destruct (peq p q); constructor; auto. }
  induction 1; cbn [common fold_right]; auto.
Qed.
Fixpoint take (p : poly) (n : nat) (b : factors) : option factors :=
  match b with
  | [] => None
  | (q, m) :: b =>
      if peq p q then if Nat.leb n m then Some ((q, m - n)%nat :: b) else None else option_map (cons (q, m)) (take p n b)
  end.
Lemma take_ok l p n b : forall c, take p n b = Some c -> over l b = value l p ^ n * over l c.
Proof.
  unfold over. induction b as [|[q m] b IH]; intros c; cbn [take]; [discriminate|].
  destruct (peq p q) eqn:E.
  - destruct (Nat.leb_spec n m); [|discriminate]. intros [= <-]. cbn [fold_right fst snd].
    rewrite (peq_ok l p q E), <- Rmult_assoc, <- pow_add. do 2 f_equal. lia.
  - destruct (take p n b) as [r|]; [|discriminate]. intros [= <-]. cbn [fold_right fst snd].
    rewrite (IH r eq_refl). ring.
Qed.
Fixpoint take_all (a b : factors) : option factors :=
  match a with [] => Some b | (p, n) :: a => match take p n b with Some c => take_all a c | None => None end end.
Lemma take_all_ok l a : forall b c, take_all a b = Some c -> over l b = over l a * over l c.
Proof.
  induction a as [|[p n] a IH]; intros b c; cbn [take_all].
  - intros [= <-]. cbn. ring.
  - destruct (take p n b) as [r|] eqn:T; [|discriminate]. intros H.
    rewrite (take_ok l p n b r T), (IH r c H). unfold over. cbn [fold_right fst snd]. ring.
Qed.

Section Arithmetic.
Variable r : rules.

Definition whole (p : poly) : fraction := {| top := p; bottom := [] |}.
Definition fopp (a : fraction) : fraction := {| top := popp (top a); bottom := bottom a |}.
Definition fadd (a b : fraction) : fraction :=
  if peq (top a) zero then b else if peq (top b) zero then a else
    let c := common (bottom a) (bottom b) in
    match take_all (bottom a) c, take_all (bottom b) c with
    | Some p, Some q =>
        {| top := reduce r (padd (product (top a) (expanded r p)) (product (top b) (expanded r q))); bottom := c |}
    | _, _ =>
        {| top := reduce r (padd (product (top a) (expanded r (bottom b))) (product (top b) (expanded r (bottom a))));
           bottom := bottom a ++ bottom b |}
    end.
(** A factor that is the whole of the other's top is not multiplied and divided by. *)
Definition cancelled (p : poly) (b : factors) : poly * factors :=
  match take p 1 b with Some c => (one, c) | None => (p, b) end.
Fixpoint insert (p : poly) (n : nat) (b : factors) : factors :=
  match b with
  | [] => [(p, n)]
  | (q, m) :: b => if peq p q then (q, m + n)%nat :: b else (q, m) :: insert p n b
  end.
Definition together (a b : factors) : factors := fold_right (fun f => insert (fst f) (snd f)) a b.
Definition fmul (a b : fraction) : fraction :=
  if peq (top a) zero || peq (top b) zero then whole zero else
  let pc := cancelled (top a) (bottom b) in
  let qe := cancelled (top b) (bottom a) in
  {| top := reduce r (product (fst pc) (fst qe)); bottom := together (snd pc) (snd qe) |}.
Definition finv (a : fraction) : fraction :=
  {| top := expanded r (bottom a); bottom := if peq (top a) one then [] else [(top a, 1%nat)] |}.
Definition fpow (n : nat) (a : fraction) : fraction :=
  {| top := power r (top a) n; bottom := map (fun f => (fst f, (snd f * n)%nat)) (bottom a) |}.

Variable l : list R.
Hypothesis rules_hold : hold r l.
Lemma whole_ok p : means l (whole p) (value l p).
Proof. split; [constructor|]. cbn. ring. Qed.
Lemma fopp_ok a y : means l a y -> means l (fopp a) (- y).
Proof. intros [N H]. split; [exact N|]. cbn [fopp top bottom]. rewrite popp_ok, <- H. ring. Qed.
Lemma nothing a y : means l a y -> peq (top a) zero = true -> y = 0.
Proof.
  intros [N H] E. rewrite (peq_ok l _ _ E) in H. change (value l zero) with 0 in H.
  apply Rmult_integral in H. destruct H as [H|H]; [exact H|]. destruct (over_nonzero _ _ N H).
Qed.
Lemma fadd_ok a b y z : means l a y -> means l b z -> means l (fadd a b) (y + z).
Proof.
  intros A B. unfold fadd. destruct (peq (top a) zero) eqn:EA.
  { rewrite (nothing _ _ A EA), Rplus_0_l. exact B. }
  destruct (peq (top b) zero) eqn:EB. { rewrite (nothing _ _ B EB), Rplus_0_r. exact A. }
  destruct A as [NA HA], B as [NB HB]. cbv zeta.
  destruct (take_all (bottom a) _) as [p|] eqn:TA; [destruct (take_all (bottom b) _) as [q|] eqn:TB|].
  1: { split; cbn [top bottom]; [apply common_nonzero; auto|].
    rewrite reduce_ok, padd_ok, !product_ok, !expanded_ok, <- HA, <- HB by auto.
    rewrite Rmult_plus_distr_r. rewrite (take_all_ok l _ _ _ TA) at 1. rewrite (take_all_ok l _ _ _ TB). ring. }
  all: split; cbn [top bottom]; [apply nonzero_app; auto|];
    rewrite reduce_ok, padd_ok, !product_ok, !expanded_ok, <- HA, <- HB, over_app by auto; ring.
Qed.
Lemma take_nonzero p n b : forall c, take p n b = Some c -> nonzero l b -> nonzero l c.
Proof.
  induction b as [|[q m] b IH]; intros c; cbn [take]; [discriminate|]. destruct (peq p q).
  - destruct (Nat.leb n m); [|discriminate]. intros [= <-] H. inversion H; constructor; auto.
  - destruct (take p n b); [|discriminate]. intros [= <-] H. inversion H; constructor; [auto|apply IH; auto].
Qed.
Lemma cancelled_ok p b : nonzero l b ->
  nonzero l (snd (cancelled p b)) /\ value l p * over l (snd (cancelled p b)) = value l (fst (cancelled p b)) * over l b.
Proof.
  intros N. unfold cancelled. destruct (take p 1 b) as [c|] eqn:T; cbn [fst snd]; [|auto].
  split; [eapply take_nonzero; eauto|]. rewrite (take_ok l p 1 b c T). cbn. ring.
Qed.
Lemma insert_ok p n b : over l (insert p n b) = value l p ^ n * over l b.
Proof.
  unfold over. induction b as [|[q m] b IH]; cbn [insert fold_right fst snd]; [ring|]. destruct (peq p q) eqn:E; cbn [fold_right fst snd].
  - rewrite (peq_ok l p q E), pow_add. ring.
  - rewrite IH. ring.
Qed.
Lemma insert_nonzero p n b : value l p <> 0 -> nonzero l b -> nonzero l (insert p n b).
Proof.
  intros P. induction 1 as [|[q m] b Q H IH]; cbn [insert]; [constructor; auto; constructor|].
  destruct (peq p q); constructor; auto.
Qed.
Lemma together_ok a b : over l (together a b) = over l a * over l b.
Proof.
  unfold together. induction b as [|[p n] b IH]; cbn [fold_right fst snd]; [cbn; ring|].
  rewrite insert_ok, IH. unfold over at 4. cbn [fold_right fst snd]. unfold over. ring.
Qed.
Lemma together_nonzero a b : nonzero l a -> nonzero l b -> nonzero l (together a b).
Proof. intros A. unfold together. induction 1; cbn [fold_right]; auto. apply insert_nonzero; auto. Qed.
Lemma fmul_ok a b y z : means l a y -> means l b z -> means l (fmul a b) (y * z).
Proof.
  intros A B. unfold fmul. destruct (peq (top a) zero) eqn:EA.
  { rewrite (nothing _ _ A EA), Rmult_0_l. apply whole_ok. }
  destruct (peq (top b) zero) eqn:EB; cbn [orb]. { rewrite (nothing _ _ B EB), Rmult_0_r. apply whole_ok. }
  destruct A as [NA HA], B as [NB HB]. cbv zeta.
  destruct (cancelled_ok (top a) _ NB) as [NC C], (cancelled_ok (top b) _ NA) as [ND D].
  set (pc := cancelled (top a) (bottom b)) in *. set (qe := cancelled (top b) (bottom a)) in *.
  split; cbn [top bottom]; [apply together_nonzero; auto|].
  rewrite reduce_ok, product_ok, together_ok by auto.
  apply (Rmult_eq_reg_r (over l (bottom a) * over l (bottom b)));
    [|apply Rmult_integral_contrapositive_currified; apply over_nonzero; auto].
  transitivity ((y * over l (bottom a)) * over l (snd pc) * ((z * over l (bottom b)) * over l (snd qe))); [ring|].
  rewrite HA, HB, C, D. ring.
Qed.
Lemma finv_ok a y : means l a y -> y <> 0 -> means l (finv a) (/ y).
Proof.
  intros [N H] Y. assert (T : value l (top a) <> 0).
  { rewrite <- H. apply Rmult_integral_contrapositive_currified; [exact Y|apply over_nonzero, N]. }
  unfold finv. destruct (peq (top a) one) eqn:E; split; cbn [top bottom]; try (constructor; [exact T|constructor]);
    try constructor; rewrite expanded_ok by auto; cbn [over fold_right fst snd].
  - rewrite (peq_ok l _ _ E) in H. change (value l one) with 1 in H. field_simplify; auto.
    apply (Rmult_eq_reg_l y); auto. rewrite H. field; auto.
  - rewrite <- H. unfold over. field; auto.
Qed.
Lemma fpow_ok n a y : means l a y -> means l (fpow n a) (y ^ n).
Proof.
  intros [N H]. unfold fpow. split; cbn [top bottom].
  - clear H. induction N; cbn [map]; constructor; auto.
  - rewrite power_ok, <- H, Rpow_mult_distr by auto. f_equal. clear.
    unfold over. induction (bottom a) as [|[p m] b IH]; cbn [map fold_right fst snd]; [symmetry; apply pow1|].
    rewrite IH, Rpow_mult_distr, pow_mult. reflexivity.
Qed.
End Arithmetic.

(** * From terms to fractions *)

(** The fraction of a term, or of its inverse. *)
Fixpoint fraction_of (r : rules) (atoms : list term) (e : term) (inverted : bool) : option fraction :=
  let turn f := if inverted then finv r f else f in
  match e with
  | Mul a b => both (fmul r) (fraction_of r atoms a inverted) (fraction_of r atoms b inverted)
  | Opp a => option_map fopp (fraction_of r atoms a inverted)
  | Inv a => fraction_of r atoms a (negb inverted)
  | Pow a O => Some (whole one)
  | Pow a n => option_map (fpow r n) (fraction_of r atoms a inverted)
  | Cst z => Some (turn (whole (Pc z)))
  | Add a b => option_map turn (both (fadd r) (fraction_of r atoms a false) (fraction_of r atoms b false))
  | Sub a b => option_map turn (both (fun a b => fadd r a (fopp b)) (fraction_of r atoms a false) (fraction_of r atoms b false))
  | Sin a => option_map (fun s => turn (whole (reduce r (fst s)))) (sine_and_cosine atoms a)
  | Cos a => option_map (fun s => turn (whole (reduce r (snd s)))) (sine_and_cosine atoms a)
  | _ => option_map (fun p => turn (whole p)) (atom atoms e)
  end.
Lemma fraction_of_ok x r atoms (l := map (eval x) atoms) : hold r l -> forall e inverted f,
  fraction_of r atoms e inverted = Some f -> defined x e -> (inverted = true -> eval x e <> 0) ->
  means l f (if inverted then / eval x e else eval x e).
Proof.
  intros H. assert (turn : forall (inverted : bool) f y, means l f y -> (inverted = true -> y <> 0) ->
    means l (if inverted then finv r f else f) (if inverted then / y else y)).
  { intros [] f y M N; [apply finv_ok; auto|exact M]. }
  assert (is_atom : forall e inverted f, option_map (fun p => if inverted : bool then finv r (whole p) else whole p) (atom atoms e) = Some f ->
    (inverted = true -> eval x e <> 0) -> means l f (if inverted then / eval x e else eval x e)).
  { intros e inverted f. destruct (atom atoms e) as [p|] eqn:A; [|discriminate]. intros [= <-] N.
    apply turn; [|exact N]. rewrite <- (atom_ok x _ _ _ A). apply whole_ok. }
  induction e; intros inverted f; cbn [fraction_of defined];
    try (intros E D N; apply (is_atom _ inverted f E N); fail).
  - intros [= <-] _ N. apply turn; [apply (whole_ok l (Pc z))|exact N].
  - destruct (fraction_of r atoms e1 false) as [q|] eqn:E1, (fraction_of r atoms e2 false) as [w|] eqn:E2; cbn [both option_map]; try discriminate. intros [= <-] [D1 D2] N.
    apply turn; [|exact N]. cbn [eval]. apply fadd_ok; auto; [apply (IHe1 false _ E1 D1)|apply (IHe2 false _ E2 D2)]; discriminate.
  - destruct (fraction_of r atoms e1 false) as [q|] eqn:E1, (fraction_of r atoms e2 false) as [w|] eqn:E2; cbn [both option_map]; try discriminate. intros [= <-] [D1 D2] N.
    apply turn; [|exact N]. cbn [eval]. unfold Rminus. apply fadd_ok; [auto| |apply fopp_ok];
      [apply (IHe1 false _ E1 D1)|apply (IHe2 false _ E2 D2)]; discriminate.
  - destruct (fraction_of r atoms e1 inverted) as [a|] eqn:E1, (fraction_of r atoms e2 inverted) as [b|] eqn:E2; cbn [both option_map]; try discriminate.
    intros [= <-] [D1 D2] N. cbn [eval] in *.
    assert (N1 : inverted = true -> eval x e1 <> 0) by (intros I Z; apply (N I); rewrite Z; ring).
    assert (N2 : inverted = true -> eval x e2 <> 0) by (intros I Z; apply (N I); rewrite Z; ring).
    specialize (IHe1 _ _ E1 D1 N1). specialize (IHe2 _ _ E2 D2 N2).
    replace (if inverted then / (eval x e1 * eval x e2) else eval x e1 * eval x e2)
      with ((if inverted then / eval x e1 else eval x e1) * (if inverted then / eval x e2 else eval x e2)).
    + apply fmul_ok; auto.
    + destruct inverted; [|reflexivity]. field. split; [apply N2|apply N1]; reflexivity.
  - destruct (fraction_of r atoms e inverted) as [a|] eqn:E; [|discriminate]; cbn [option_map]. intros [= <-] D N. cbn [eval] in *.
    assert (N1 : inverted = true -> eval x e <> 0) by (intros I Z; apply (N I); rewrite Z; ring).
    specialize (IHe _ _ E D N1).
    replace (if inverted then / - eval x e else - eval x e) with (- (if inverted then / eval x e else eval x e)).
    + apply fopp_ok, IHe.
    + destruct inverted; [|reflexivity]. field. apply N1; reflexivity.
  - intros E [D0 D] N. cbn [eval] in *. specialize (IHe _ _ E D0). destruct inverted; cbn [negb] in *.
    + rewrite Rinv_inv. apply IHe. discriminate.
    + apply IHe. auto.
  - destruct n as [|n].
    { intros [= <-] _ _. cbn [eval pow]. destruct inverted; [rewrite Rinv_1|]; apply (whole_ok l one). }
    destruct (fraction_of r atoms e inverted) as [a|] eqn:E; [|discriminate]; cbn [option_map]. intros [= <-] D N. cbn [eval] in *.
    assert (N1 : inverted = true -> eval x e <> 0) by (intros I Z; apply (N I); rewrite Z; cbn [pow]; ring).
    specialize (IHe _ _ E D N1).
    replace (if inverted then / eval x e ^ S n else eval x e ^ S n)
      with ((if inverted then / eval x e else eval x e) ^ S n) by (destruct inverted; [apply pow_inv|reflexivity]).
    apply fpow_ok; auto.
  - destruct (sine_and_cosine atoms e) as [a|] eqn:S; [|discriminate]; cbn [option_map]. intros [= <-] _ N.
    apply (sine_and_cosine_ok x) in S. destruct S as [S _]. apply turn; [|exact N]. cbn [eval]. rewrite <- S. fold l.
    rewrite <- (reduce_ok r l (fst a) H). apply whole_ok.
  - destruct (sine_and_cosine atoms e) as [a|] eqn:S; [|discriminate]; cbn [option_map]. intros [= <-] _ N.
    apply (sine_and_cosine_ok x) in S. destruct S as [_ S]. apply turn; [|exact N]. cbn [eval]. rewrite <- S. fold l.
    rewrite <- (reduce_ok r l (snd a) H). apply whole_ok.
Qed.

(** ** The atoms of a term *)

Definition with_atom (e : term) (atoms : list term) := if in_dec term_eq_dec e atoms then atoms else e :: atoms.
Fixpoint with_angles_of (e : term) (atoms : list term) : list term :=
  match quarters e with
  | Some _ => atoms
  | None =>
      match e with
      | Add a b | Sub a b => with_angles_of a (with_angles_of b atoms)
      | Opp a => with_angles_of a atoms
      | Mul (Cst z) a =>
          if (Z.abs z <=? most)%Z then with_angles_of a atoms else with_atom (Sin e) (with_atom (Cos e) atoms)
      | _ => with_atom (Sin e) (with_atom (Cos e) atoms)
      end
  end.
Fixpoint with_atoms_of (e : term) (atoms : list term) : list term :=
  match e with
  | Cst _ => atoms
  | Add a b | Sub a b | Mul a b => with_atoms_of a (with_atoms_of b atoms)
  | Opp a | Inv a | Pow a _ => with_atoms_of a atoms
  | Sin a | Cos a => with_angles_of a atoms
  | Sqrt a => with_atom e (with_atoms_of a atoms)
  | _ => with_atom e atoms
  end.
(** Roots are met where they are defined. *)
Definition rooted (x : state) (e : term) := match e with Sqrt a => defined x a /\ 0 <= eval x a | _ => True end.
Lemma with_atom_rooted x e atoms : rooted x e -> Forall (rooted x) atoms -> Forall (rooted x) (with_atom e atoms).
Proof. unfold with_atom. destruct (in_dec term_eq_dec e atoms); auto. Qed.
Lemma with_angles_rooted x e : forall atoms, Forall (rooted x) atoms -> Forall (rooted x) (with_angles_of e atoms).
Proof.
  assert (whole : forall e atoms, Forall (rooted x) atoms -> Forall (rooted x) (with_atom (Sin e) (with_atom (Cos e) atoms))).
  { intros. repeat apply with_atom_rooted; cbn; auto. }
  induction e; intros atoms F; cbn [with_angles_of]; destruct (quarters _); auto.
  destruct e1; auto. destruct (Z.abs z <=? most)%Z; auto.
Qed.
Lemma with_atoms_rooted x e : forall atoms, defined x e -> Forall (rooted x) atoms -> Forall (rooted x) (with_atoms_of e atoms).
Proof.
  induction e; intros atoms D F; cbn [with_atoms_of defined] in *; try (apply with_angles_rooted; auto);
    try (apply with_atom_rooted; cbn; auto; fail); try (destruct D; auto; fail); auto.
  destruct D. apply with_atom_rooted; cbn; auto.
Qed.

(** ** The rules for them *)

Definition square (a p : poly) : rules :=
  match mon_of_pol 0%Z Zeq_bool (product a a) with Some m => [(m, p)] | None => [] end.
Lemma square_ok l a p r : value l a * value l a = value l p -> hold r l -> hold (square a p ++ r) l.
Proof.
  intros E H. unfold square. destruct (mon_of_pol 0%Z Zeq_bool (product a a)) as [m|] eqn:M; [|exact H].
  cbn [app MPcond]. split; [|exact H]. rewrite (mon_of_pol_ok (Eqsth R) extends almost R_rm _ M), product_ok. exact E.
Qed.
Definition circle (atoms : list term) (e : term) : rules :=
  match e with
  | Sin a => match atom atoms e, atom atoms (Cos a) with
             | Some s, Some c => square s (psub one (product c c))
             | _, _ => [] end
  | _ => []
  end.
Definition circles (atoms : list term) : rules := flat_map (circle atoms) atoms.
Lemma circles_hold x atoms : hold (circles atoms) (map (eval x) atoms).
Proof.
  enough (H : forall some, hold (flat_map (circle atoms) some) (map (eval x) atoms)) by apply H.
  induction some as [|e some IH]; cbn [flat_map]; [exact I|].
  destruct e; auto. cbn [circle]. destruct (atom atoms (Sin e)) as [s|] eqn:S; [|exact IH].
  destruct (atom atoms (Cos e)) as [c|] eqn:C; [|exact IH].
  apply square_ok; [|exact IH]. rewrite psub_ok, product_ok, (atom_ok x _ _ _ S), (atom_ok x _ _ _ C).
  change (value _ one) with 1. cbn [eval]. pose proof (sin2_cos2 (eval x e)) as T. unfold Rsqr in T. lra.
Qed.
Definition root (atoms : list term) (e : term) : rules :=
  match e with
  | Sqrt a => match atom atoms e, fraction_of (circles atoms) atoms a false with
              | Some q, Some {| top := p; bottom := [] |} => square q p
              | _, _ => [] end
  | _ => []
  end.
Definition rules_of (atoms : list term) : rules := flat_map (root atoms) atoms ++ circles atoms.
Lemma rules_hold x atoms : Forall (rooted x) atoms -> hold (rules_of atoms) (map (eval x) atoms).
Proof.
  enough (H : forall some, Forall (rooted x) some ->
    hold (flat_map (root atoms) some ++ circles atoms) (map (eval x) atoms)) by apply H.
  induction some as [|e some IH]; intros F; cbn [flat_map app].
  { apply circles_hold. }
  inversion F as [|? ? Re Fs]; subst. rewrite <- app_assoc. specialize (IH Fs). destruct e; auto. cbn [root].
  destruct (atom atoms (Sqrt e)) as [q|] eqn:Q; [|exact IH].
  destruct (fraction_of (circles atoms) atoms e false) as [[p [|f b]]|] eqn:E; auto. destruct Re as [D P].
  apply square_ok; [|exact IH]. rewrite (atom_ok x _ _ _ Q). cbn [eval]. rewrite sqrt_def by auto.
  destruct (fraction_of_ok x _ atoms (circles_hold x atoms) e false _ E D ltac:(discriminate)) as [_ M].
  cbn in M. rewrite <- M. ring.
Qed.

(** * The decisions *)

(** Whether two terms are shown to be equal wherever both are defined. *)
Definition same (a b : term) : bool :=
  let atoms := with_atoms_of a (with_atoms_of b []) in
  match fraction_of (rules_of atoms) atoms (Sub a b) false with Some f => peq (top f) zero | None => false end.
Theorem same_correct a b : same a b = true -> equal a b.
Proof.
  unfold same. cbv zeta. set (atoms := with_atoms_of a (with_atoms_of b [])). intros H x A B.
  destruct (fraction_of (rules_of atoms) atoms (Sub a b) false) as [f|] eqn:E; [|discriminate].
  assert (F : Forall (rooted x) atoms) by (repeat (apply with_atoms_rooted; auto)).
  pose proof (fraction_of_ok x _ atoms (rules_hold x atoms F) _ false f E (conj A B) ltac:(discriminate)) as M.
  apply (nothing _ _ _ M) in H. cbn [eval] in H. lra.
Qed.

(** The variables that conditions give. *)
Fixpoint given (conditions : list condition) : list (term * term) :=
  match conditions with
  | Equal (Var v) e :: more | Equal e (Var v) :: more => (Var v, e) :: given more
  | _ :: more => given more
  | [] => []
  end.
(** Conditions may mention what others give: they are put in as often as there are some. *)
Definition put_in (conditions : list condition) (e : term) : term :=
  let s := given conditions in fold_right (fun _ e => subst (put s) e) e s.
Definition same_where (conditions : list condition) (a b : term) : bool :=
  same (put_in conditions a) (put_in conditions b).
Lemma put_given x conditions v : Forall (meets x) conditions ->
  eval x (put (given conditions) v) = x v /\ defined x (put (given conditions) v).
Proof.
  induction 1 as [|c more H _ IH]; cbn [given put]; [split; [reflexivity|exact I]|].
  destruct c; auto. destruct H as [Da [Db E]].
  assert (one : forall w e, defined x e -> eval x e = x w -> eval x (put ((Var w, e) :: given more) v) = x v /\
    defined x (put ((Var w, e) :: given more) v)).
  { intros w e D V. cbn [put same_variable]. destruct (Pos.eqb_spec w v) as [<-|_]; auto. }
  destruct a; try (apply one; [exact Db|symmetry; exact E]; fail);
    destruct b; auto; try (apply one; [exact Da|exact E]).
Qed.
Lemma put_in_ok x conditions e : Forall (meets x) conditions -> defined x e ->
  eval x (put_in conditions e) = eval x e /\ defined x (put_in conditions e).
Proof.
  intros M D. unfold put_in.
  enough (H : forall so_often : list (term * term), let found := fold_right (fun _ e => subst (put (given conditions)) e) e so_often in
    eval x found = eval x e /\ defined x found) by apply H.
  induction so_often as [|z more [IH ID]]; cbn [fold_right]; [auto|].
  assert (same_state : forall v, eval x (put (given conditions) v) = x v) by (intro; apply put_given, M).
  split.
  - rewrite subst_ok, <- IH. apply eval_ext, same_state.
  - apply defined_subst; [intro; apply put_given, M|]. eapply defined_ext; [|exact ID]. intro; symmetry; apply same_state.
Qed.
Theorem same_where_correct conditions a b : same_where conditions a b = true -> equal_where conditions a b.
Proof.
  intros H x M A B. destruct (put_in_ok x _ _ M A) as [<- DA], (put_in_ok x _ _ M B) as [<- DB].
  apply (same_correct _ _ H); auto.
Qed.

Fixpoint for_all {A} (ok : A -> A -> bool) (l r : list A) : bool :=
  match l, r with [], [] => true | a :: l, b :: r => ok a b && for_all ok l r | _, _ => false end.
Lemma for_all_ok {A} (ok : A -> A -> bool) (P : A -> A -> Prop) :
  (forall a b, ok a b = true -> P a b) -> forall l r, for_all ok l r = true -> Forall2 P l r.
Proof.
  intros H. induction l as [|a l IH]; intros [|b r]; cbn; try discriminate; constructor;
    apply andb_prop in H0; destruct H0; auto.
Qed.
Theorem same_matrices_correct m n : for_all (for_all same) m n = true -> equal_matrices m n.
Proof. apply for_all_ok, for_all_ok, same_correct. Qed.
Theorem same_matrices_where_correct c m n : for_all (for_all (same_where c)) m n = true -> equal_matrices_where c m n.
Proof. apply for_all_ok, for_all_ok, same_where_correct. Qed.

(** The proof of one line. *)
Ltac identity :=
  first [ apply same_correct | apply same_where_correct | apply same_matrices_correct | apply same_matrices_where_correct ];
  vm_cast_no_check (eq_refl true).
