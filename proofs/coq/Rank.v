(** Ranks: rows that are independent at a state in exact numbers, and that there are never more. *)

Require Import Reals QArith Qreals Lra Lia.
From Palmistry Require Import Lie Check Point.
Local Open Scope R_scope.

(** * What a rank is *)

(** The sum of rows with some factors, in one column. *)
Definition combination (factors : list R) (rows : list (list R)) (column : nat) : R :=
  fold_right Rplus 0 (zip (fun a row => a * nth column row 0) factors rows).
(** No combination vanishes in all columns but that with no factor. *)
Definition independent (rows : list (list R)) : Prop :=
  forall factors, length factors = length rows ->
    (forall column, combination factors rows column = 0) -> Forall (fun a => a = 0) factors.

(** The rows of a matrix at a state. *)
Definition rows_at (x : state) (m : matrix) : list (list R) := map (map (eval x)) m.
(** So many rows are independent at a state that meets the conditions, and at which all entries have values. *)
Definition rank_among (conditions : list condition) (m : matrix) (x : state) (chosen : matrix) : Prop :=
  Forall (meets x) conditions /\ Forall (Forall (defined x)) m /\ incl chosen m /\ independent (rows_at x chosen).
Definition rank_reaches conditions m (r : nat) : Prop := exists x chosen, rank_among conditions m x chosen /\ length chosen = r.
(** And nowhere more: this is the generic rank where the conditions leave one piece, on which the entries are analytic. *)
Definition greatest_rank conditions m (r : nat) : Prop :=
  rank_reaches conditions m r /\ forall x chosen, rank_among conditions m x chosen -> (length chosen <= r)%nat.

(** The outputs and their Lie derivatives along the fields. *)
Inductive lie_derivative (fields : list vector_field) (outputs : list term) : term -> Prop :=
| an_output h : In h outputs -> lie_derivative fields outputs h
| along f e : In f fields -> lie_derivative fields outputs e -> lie_derivative fields outputs (L f e).
(** The differentials of some terms by the unknowns: rows of the observability codistribution. *)
Definition differentials (unknowns es : list term) : matrix := map (fun e => map (fun y => d y e) unknowns) es.
(** The same of the codistribution of a system. *)
Definition observability_among (conditions : list condition) (fields : list vector_field) (outputs unknowns : list term)
    (x : state) (es : list term) : Prop :=
  Forall (meets x) conditions /\ Forall (lie_derivative fields outputs) es /\ Forall (smooth x) es /\
  independent (rows_at x (differentials unknowns es)).
Definition observability_rank_reaches conditions fields outputs unknowns (r : nat) : Prop :=
  exists x es, observability_among conditions fields outputs unknowns x es /\ length es = r.
Definition greatest_observability_rank conditions fields outputs unknowns (r : nat) : Prop :=
  observability_rank_reaches conditions fields outputs unknowns r /\
  forall x es, observability_among conditions fields outputs unknowns x es -> (length es <= r)%nat.

(** * There are no more independent rows than columns *)

Lemma combination_cons a row factors rows column :
  combination (a :: factors) (row :: rows) column = a * nth column row 0 + combination factors rows column.
Proof. reflexivity. Qed.
Lemma combination_app f g l m column : length f = length l ->
  combination (f ++ g) (l ++ m) column = combination f l column + combination g m column.
Proof.
  revert l; induction f as [|a f IH]; intros [|row l]; cbn [length]; try discriminate; intros E.
  - cbn [app]. unfold combination at 2. cbn [zip fold_right]. lra.
  - cbn [app]. rewrite !combination_cons, IH by congruence. lra.
Qed.

Lemma independent_front l p m : independent (l ++ p :: m) -> independent (p :: l ++ m).
Proof.
  intros I [|a factors]; cbn [length]; try discriminate. intros E Z.
  pose (f := firstn (length l) factors). pose (g := skipn (length l) factors).
  assert (F : length f = length l) by (unfold f; rewrite firstn_length; rewrite app_length in E; lia).
  assert (S : factors = f ++ g) by (symmetry; apply firstn_skipn).
  assert (A : Forall (fun a => a = 0) (f ++ a :: g)).
  { apply I.
    - rewrite !app_length in *. cbn [length]. rewrite S, app_length in E. lia.
    - intro column. specialize (Z column). rewrite S, combination_cons, combination_app in Z by exact F.
      rewrite combination_app, combination_cons by exact F. lra. }
  apply Forall_app in A. destruct A as [A B]. inversion B. constructor; [assumption|].
  rewrite S. apply Forall_app. auto.
Qed.

(** Rows less the multiple of one of them that makes a column vanish. *)
Definition subtract (a : R) (p row : list R) (width : nat) : list R :=
  map (fun column => nth column row 0 - a * nth column p 0) (seq 0 width).
Lemma nth_of_seq (f : nat -> R) width column : (column < width)%nat -> nth column (map f (seq 0 width)) 0 = f column.
Proof.
  intros C. rewrite (nth_indep _ 0 (f 0%nat)) by (rewrite map_length, seq_length; auto). rewrite (map_nth f), seq_nth by auto. reflexivity.
Qed.
Lemma nth_subtract a p row width column :
  nth column (subtract a p row width) 0 = if (column <? width)%nat then nth column row 0 - a * nth column p 0 else 0.
Proof.
  unfold subtract. destruct (Nat.ltb_spec column width).
  - rewrite nth_of_seq by auto. reflexivity.
  - apply nth_overflow. rewrite map_length, seq_length. auto.
Qed.

Definition at_most_wide (width : nat) (rows : list (list R)) :=
  Forall (fun row => forall column, (width <= column)%nat -> nth column row 0 = 0) rows.

Lemma all_zero_or_not k (rows : list (list R)) :
  Forall (fun row => nth k row 0 = 0) rows \/ exists l p m, rows = l ++ p :: m /\ nth k p 0 <> 0.
Proof.
  induction rows as [|row rows [IH|(l & p & m & -> & N)]]; [left; constructor| |].
  - destruct (Req_dec (nth k row 0) 0) as [Z|N]; [left; constructor; auto|right]. exists [], row, rows. auto.
  - right. exists (row :: l), p, m. auto.
Qed.

Lemma combination_subtract p k width rows factors column : (column < width)%nat -> length factors = length rows ->
  combination factors (map (fun row => subtract (nth k row 0 / nth k p 0) p row width) rows) column =
  combination factors rows column - combination factors rows k / nth k p 0 * nth column p 0.
Proof.
  intros W. revert factors. induction rows as [|row rows IH]; intros [|a factors]; cbn [length]; try discriminate.
  - intros _. cbn. unfold combination; cbn. unfold Rdiv. lra.
  - intros E. cbn [map]. rewrite !combination_cons, IH by congruence. rewrite nth_subtract.
    apply Nat.ltb_lt in W. rewrite W. unfold Rdiv. lra.
Qed.
Lemma combination_beyond rows factors column :
  Forall (fun row => nth column row 0 = 0) rows -> combination factors rows column = 0.
Proof.
  intros H. revert factors. induction H as [|row rows Z _ IH]; intros [|a factors]; try reflexivity.
  rewrite combination_cons, Z, IH. lra.
Qed.

Lemma reduced_independent p k rows width : (k < width)%nat -> at_most_wide width (p :: rows) -> nth k p 0 <> 0 ->
  independent (p :: rows) -> independent (map (fun row => subtract (nth k row 0 / nth k p 0) p row width) rows).
Proof.
  intros K W N I factors E Z. rewrite map_length in E.
  assert (A : Forall (fun a => a = 0) (- (combination factors rows k / nth k p 0) :: factors)).
  { apply I; [cbn; congruence|]. intro column. rewrite combination_cons. destruct (Nat.lt_ge_cases column width) as [L|G].
    - specialize (Z column). rewrite combination_subtract in Z by auto. lra.
    - inversion W as [|? ? P R]. subst. rewrite (P column) by auto. rewrite Rmult_0_r, combination_beyond; [lra|].
      eapply Forall_impl; [|exact R]. cbn; auto. }
  inversion A; assumption.
Qed.

Theorem independent_bounded width : forall rows, at_most_wide width rows -> independent rows -> (length rows <= width)%nat.
Proof.
  induction width as [|k IH]; intros rows W I.
  - destruct rows as [|p rows]; [auto|exfalso].
    assert (A : Forall (fun a => a = 0) (1 :: map (fun _ => 0) rows)).
    { apply I; [cbn; rewrite map_length; auto|]. intro column. apply combination_beyond.
      eapply Forall_impl; [|exact W]. cbn. intros row H. apply H. lia. }
    inversion A. lra.
  - destruct (all_zero_or_not k rows) as [Z|(l & p & m & -> & N)].
    + enough (length rows <= k)%nat by lia. apply IH; [|exact I].
      unfold at_most_wide in *. rewrite Forall_forall in *. intros row R column C.
      destruct (Nat.eq_dec column k) as [->|D]; [apply Z, R|apply (W row R); lia].
    + apply independent_front in I.
      assert (V : at_most_wide (S k) (p :: l ++ m)).
      { apply Forall_app in W. destruct W as [A B]. inversion B. constructor; [assumption|]. apply Forall_app; auto. }
      pose proof (reduced_independent p k (l ++ m) (S k) (Nat.lt_succ_diag_r k) V N I) as J.
      apply IH in J.
      * rewrite map_length, app_length in J. rewrite app_length. cbn [length]. lia.
      * apply Forall_forall. intros row R. apply in_map_iff in R. destruct R as (q & <- & Q). intros column C.
        rewrite nth_subtract. destruct (Nat.ltb_spec column (S k)) as [L|G]; [|reflexivity].
        replace column with k by lia. field. exact N.
Qed.

(** * Rows in exact numbers, by elimination *)

Fixpoint first_nonzero (row : list Q) : option nat :=
  match row with [] => None | a :: more => if Qeq_bool a 0 then option_map S (first_nonzero more) else Some 0%nat end.
(** A row of Q without the part that makes its place [k] vanish. *)
Definition eliminate_from (p : list Q) (k : nat) (row : list Q) : list Q :=
  let a := nth k row 0%Q in
  if Qeq_bool a 0 then row else let by_ := Qred (a / nth k p 0%Q)%Q in zip (fun b c => Qred (b - by_ * c)%Q) row p.
Fixpoint are_independent (fuel width : nat) (rows : list (list Q)) : bool :=
  match fuel, rows with
  | _, [] => true
  | S fuel, p :: rows =>
      forallb (fun row => Nat.eqb (length row) width) (p :: rows) &&
      match first_nonzero p with None => false | Some k => are_independent fuel width (map (eliminate_from p k) rows) end
  | O, _ => false
  end.

Lemma first_nonzero_ok row : forall k, first_nonzero row = Some k -> ~ (nth k row 0%Q == 0)%Q.
Proof.
  induction row as [|a row IH]; cbn; try discriminate. intros k. destruct (Qeq_bool a 0) eqn:E.
  - destruct (first_nonzero row); try discriminate. intros [= <-]. cbn. auto.
  - intros [= <-]. cbn. apply Qeq_bool_neq, E.
Qed.
Lemma nth_Q2R row k : nth k (map Q2R row) 0 = Q2R (nth k row 0%Q).
Proof. rewrite <- (map_nth Q2R). f_equal. symmetry. exact (Q2R_Z 0). Qed.
Lemma nth_zip (f : Q -> Q -> Q) l m : length l = length m -> forall column, (column < length l)%nat ->
  nth column (zip f l m) 0%Q = f (nth column l 0%Q) (nth column m 0%Q).
Proof.
  revert m; induction l as [|a l IH]; intros [|b m]; cbn; try discriminate; intros E column C; [lia|].
  destruct column; [reflexivity|]. apply IH; lia.
Qed.
Lemma length_zip (f : Q -> Q -> Q) l m : length l = length m -> length (zip f l m) = length l.
Proof. revert m; induction l as [|a l IH]; intros [|b m]; cbn; try discriminate; auto. Qed.

(** A row after elimination is the row less a multiple of the first one. *)
Lemma eliminate_from_ok p k row : length row = length p ->
  exists a, forall column, Q2R (nth column (eliminate_from p k row) 0%Q) = Q2R (nth column row 0%Q) - a * Q2R (nth column p 0%Q).
Proof.
  intros E. unfold eliminate_from. destruct (Qeq_bool (nth k row 0%Q) 0); [exists 0; intros; lra|].
  exists (Q2R (Qred (nth k row 0%Q / nth k p 0%Q)%Q)). intros column. destruct (Nat.lt_ge_cases column (length row)) as [C|C].
  - rewrite nth_zip by auto. rewrite Qred_R, Q2R_minus, Q2R_mult. reflexivity.
  - assert (P : (length p <= column)%nat) by lia. rewrite (nth_overflow row _ C), (nth_overflow p _ P).
    rewrite nth_overflow by (rewrite length_zip; lia). rewrite Q2R_0'. ring.
Qed.

(** What is independent less multiples of a row that has a column for itself was so with it. *)
Lemma are_independent_ok width : forall fuel rows, are_independent fuel width rows = true -> independent (map (map Q2R) rows).
Proof.
  assert (nothing : independent []).
  { intros [|a factors] E _; [constructor|discriminate]. }
  induction fuel as [|fuel IH]; intros [|p rows]; cbn [are_independent]; try discriminate; try (intros _; exact nothing).
  intros H. apply Bool.andb_true_iff in H. destruct H as [W H]. destruct (first_nonzero p) as [k|] eqn:K; [|discriminate].
  apply IH in H. cbn [forallb] in W. apply Bool.andb_true_iff in W. destruct W as [P W].
  apply Nat.eqb_eq in P. rewrite forallb_forall in W.
  intros [|c factors]; cbn [map length]; try discriminate. rewrite map_length. intros E Z.
  assert (N : Q2R (nth k p 0%Q) <> 0).
  { intros N. apply (first_nonzero_ok p k K). apply eqR_Qeq. rewrite N. symmetry. apply Q2R_0'. }
  assert (S : exists s, forall column,
    combination factors (map (map Q2R) (map (eliminate_from p k) rows)) column =
    combination factors (map (map Q2R) rows) column - s * Q2R (nth column p 0%Q) /\
    True).
  { clear - E W P. injection E as E. revert factors E. induction rows as [|row rows IH]; intros [|a factors]; cbn [length]; try discriminate; intros E.
    - exists 0. intros. cbn. unfold combination; cbn. split; [lra|auto].
    - destruct (IH) with (factors := factors) as [s S]; [intros; apply W; right; auto|auto|].
      destruct (eliminate_from_ok p k row) as [b B].
      { specialize (W row (or_introl eq_refl)). apply Nat.eqb_eq in W. congruence. }
      exists (s + a * b). intros column. split; [|auto]. destruct (S column) as [S' _]. cbn [map]. rewrite !combination_cons, S', !nth_Q2R, B. lra. }
  destruct S as [s S].
  (* in the column of the pivot the reduced rows vanish by the first row alone *)
  assert (A : forall column, combination factors (map (map Q2R) (map (eliminate_from p k) rows)) column = - (c + s) * Q2R (nth column p 0%Q)).
  { intro column. destruct (S column) as [S' _]. specialize (Z column). rewrite combination_cons, nth_Q2R in Z. lra. }
  assert (V : combination factors (map (map Q2R) (map (eliminate_from p k) rows)) k = 0).
  { apply combination_beyond. apply Forall_forall. intros row R. apply in_map_iff in R. destruct R as (q & <- & R).
    apply in_map_iff in R. destruct R as (o & <- & R). rewrite nth_Q2R. unfold eliminate_from.
    destruct (Qeq_bool (nth k o 0%Q) 0) eqn:O; [rewrite (Qeq_eqR _ _ (Qeq_bool_eq _ _ O)); apply Q2R_0'|].
    specialize (W o R). apply Nat.eqb_eq in W.
    destruct (Nat.lt_ge_cases k (length o)) as [C|C].
    - rewrite nth_zip by (auto; congruence). rewrite Qred_R, Q2R_minus, Q2R_mult, Qred_R, Q2R_div by (apply first_nonzero_ok; auto).
      field. exact N.
    - rewrite nth_overflow by (rewrite length_zip; [exact C|congruence]). apply Q2R_0'. }
  assert (T : c + s = 0). { specialize (A k). rewrite V in A. nra. }
  assert (F : Forall (fun a => a = 0) factors).
  { apply H; [rewrite !map_length in *; congruence|]. intro column. rewrite A, T. lra. }
  constructor; [|exact F]. specialize (Z k). rewrite combination_cons, nth_Q2R in Z.
  assert (combination factors (map (map Q2R) rows) k = 0).
  { clear - F. generalize (map (map Q2R) rows) as l. induction F as [|a factors -> _ IH]; intros [|row l]; try reflexivity.
    rewrite combination_cons, IH. lra. }
  nra.
Qed.

(** * What is shown of terms at a state *)

Fixpoint gathered {A} (l : list (option A)) : option (list A) :=
  match l with [] => Some [] | Some a :: l => option_map (cons a) (gathered l) | None :: _ => None end.
Lemma gathered_ok {A} (l : list (option A)) : forall found, gathered l = Some found -> l = map Some found.
Proof.
  induction l as [|[a|] l IH]; cbn; try discriminate; intros found; [intros [= <-]; reflexivity|].
  destruct (gathered l); try discriminate. intros [= <-]. cbn. rewrite <- IH; reflexivity.
Qed.

Definition exact_rows (p : place) (m : matrix) : option (list (list Q)) := gathered (map (fun row => gathered (map (value p) row)) m).
Definition are_shown_independent (p : place) (m : matrix) : bool :=
  match exact_rows p m with Some rows => are_independent (length rows) (length (hd [] rows)) rows | None => false end.

Lemma exact_row_ok p row : forall values, gathered (map (value p) row) = Some values -> map (eval (state_at p)) row = map Q2R values.
Proof.
  intros values H. apply gathered_ok in H. revert values H. induction row as [|e row IH]; intros [|a values]; cbn; try discriminate; auto.
  intros [= E F]. apply value_ok in E. destruct E as [_ ->]. rewrite (IH values F). reflexivity.
Qed.
Lemma are_shown_independent_ok p m : are_shown_independent p m = true -> independent (rows_at (state_at p) m).
Proof.
  unfold are_shown_independent. destruct (exact_rows p m) as [rows|] eqn:E; [|discriminate]. intros H. apply are_independent_ok in H.
  replace (rows_at (state_at p) m) with (map (map Q2R) rows); [exact H|]. clear H. unfold exact_rows in E. apply gathered_ok in E.
  revert rows E. induction m as [|row m IH]; intros [|values rows]; cbn; try discriminate; auto.
  intros [= E F]. rewrite (exact_row_ok p row values E), (IH rows F). reflexivity.
Qed.

(** Whether a term is shown to have a value and derivatives, also one that is not calculated: an angle, say. *)
Fixpoint is_smooth_at (p : place) (e : term) : bool :=
  let compared a (ok : Q -> bool) := match value p a with Some q => ok q | None => false end in
  match e with
  | Cst _ | Pi | Var _ => true
  | Add a b | Sub a b | Mul a b => is_smooth_at p a && is_smooth_at p b
  | Opp a | Pow a _ | Sin a | Cos a | Exp a | Atan a => is_smooth_at p a
  | Inv a => is_smooth_at p a && compared a (fun q => negb (Qeq_bool q 0))
  | Sqrt a | Ln a => is_smooth_at p a && compared a (fun q => negb (Qle_bool q 0))
  end.
Lemma smooth_at_ok p e : is_smooth_at p e = true -> smooth (state_at p) e.
Proof.
  assert (positive : forall q, negb (Qle_bool q 0) = true -> 0 < Q2R q).
  { intros q H. rewrite <- Q2R_0'. apply Qlt_Rlt, Qnot_le_lt. intros L. apply Qle_bool_iff in L. rewrite L in H. discriminate. }
  induction e; cbn [is_smooth_at smooth]; auto; try (intros H; apply Bool.andb_true_iff in H; destruct H as [A B]; auto).
  - destruct (value p e) as [q|] eqn:V; [|discriminate]. destruct (value_ok p e q V) as [_ ->]. split; [auto|].
    intros Z. apply (Qneq_bool_R _ _ B). rewrite Z. symmetry. apply Q2R_0'.
  - destruct (value p e) as [q|] eqn:V; [|discriminate]. destruct (value_ok p e q V) as [_ ->]. auto.
  - destruct (value p e) as [q|] eqn:V; [|discriminate]. destruct (value_ok p e q V) as [_ ->]. auto.
Qed.
Lemma smooth_defined x e : smooth x e -> defined x e.
Proof. induction e; cbn; try tauto. intros [A B]. split; [auto|lra]. Qed.

Lemma forallb_Forall {A} (f : A -> bool) (P : A -> Prop) l : (forall a, f a = true -> P a) -> forallb f l = true -> Forall P l.
Proof. intros H F. apply Forall_forall. intros a I. apply H. eapply forallb_forall in F; eauto. Qed.

(** ** Of a matrix *)

Definition chosen_rows (places : list nat) (m : matrix) : matrix := map (fun i => nth i m []) places.
Definition shows_rank (p : place) (places : list nat) (conditions : list condition) (m : matrix) : bool :=
  all_met p conditions && forallb (forallb (is_smooth_at p)) m && forallb (fun i => Nat.ltb i (length m)) places &&
  are_shown_independent p (chosen_rows places m).
Theorem rank_reaches_correct p places conditions m r :
  shows_rank p places conditions m && Nat.eqb (length places) r = true -> rank_reaches conditions m r.
Proof.
  unfold shows_rank. rewrite !Bool.andb_true_iff. intros [[[[C V] P] I] E]. exists (state_at p), (chosen_rows places m).
  split; [|unfold chosen_rows; rewrite map_length; apply Nat.eqb_eq, E]. split; [apply all_met_ok, C|]. split.
  { eapply forallb_Forall; [|exact V]. intros row. apply forallb_Forall. intros e E'. apply smooth_defined, smooth_at_ok, E'. }
  split; [|apply are_shown_independent_ok, I].
  intros row R. apply in_map_iff in R. destruct R as (i & <- & R). apply nth_In.
  rewrite forallb_forall in P. apply Nat.ltb_lt, P, R.
Qed.

Lemma independent_tail p rows : independent (p :: rows) -> independent rows.
Proof.
  intros I factors E Z. assert (A : Forall (fun a => a = 0) (0 :: factors)).
  { apply I; [cbn; congruence|]. intro column. rewrite combination_cons, Z. ring. }
  inversion A; assumption.
Qed.
Lemma independent_not_in p rows : independent (p :: rows) -> ~ In p rows.
Proof.
  intros I H. apply in_split in H. destruct H as (l & m & ->).
  assert (zeros : forall (rows : list (list R)) column, combination (map (fun _ => 0) rows) rows column = 0).
  { intros rows column. induction rows as [|row rows IH]; [reflexivity|]. cbn [map]. rewrite combination_cons, IH. ring. }
  assert (A : Forall (fun a => a = 0) (1 :: map (fun _ => 0) l ++ - (1) :: map (fun _ => 0) m)).
  { apply I.
    - cbn. rewrite !app_length. cbn. rewrite !map_length. reflexivity.
    - intro column. rewrite combination_cons, combination_app by apply map_length. rewrite combination_cons, !zeros. ring. }
  inversion A. lra.
Qed.
Lemma independent_distinct x (chosen : matrix) : independent (rows_at x chosen) -> NoDup chosen.
Proof.
  induction chosen as [|row chosen IH]; intros I; constructor.
  - intros H. apply (independent_not_in _ _ I). exact (in_map _ _ _ H).
  - apply IH, (independent_tail _ _ I).
Qed.

(** There are no more rows, or no more columns. *)
Definition is_narrow (m : matrix) (r : nat) : bool := Nat.leb (length m) r || forallb (fun row => Nat.leb (length row) r) m.
Theorem greatest_rank_correct p places conditions m r :
  shows_rank p places conditions m && Nat.eqb (length places) r && is_narrow m r = true -> greatest_rank conditions m r.
Proof.
  intros H. apply Bool.andb_true_iff in H. destruct H as [H N]. split; [apply (rank_reaches_correct _ _ _ _ _ H)|].
  intros x chosen (_ & _ & S & I). unfold is_narrow in N. apply Bool.orb_true_iff in N. destruct N as [N|N].
  - apply Nat.leb_le in N. pose proof (NoDup_incl_length (independent_distinct x chosen I) S). lia.
  - rewrite forallb_forall in N. replace (length chosen) with (length (rows_at x chosen)) by apply map_length.
    apply independent_bounded; [|exact I]. apply Forall_forall. intros row R column C.
    apply in_map_iff in R. destruct R as (entries & <- & R). apply S, N, Nat.leb_le in R. apply nth_overflow. rewrite map_length. lia.
Qed.

(** ** Of a codistribution *)

(** An output and the fields along which it is derived, the last one first, by their places. *)
Notation word := (list nat * nat)%type.
Definition lie_derivative_of (fields : list vector_field) (outputs : list term) (w : word) : term :=
  fold_right (fun i e => L (nth i fields (fun _ => Cst 0)) e) (nth (snd w) outputs (Cst 0)) (fst w).
Definition is_within (fields : list vector_field) (outputs : list term) (w : word) : bool :=
  forallb (fun i => Nat.ltb i (length fields)) (fst w) && Nat.ltb (snd w) (length outputs).
Lemma is_within_ok fields outputs w : is_within fields outputs w = true -> lie_derivative fields outputs (lie_derivative_of fields outputs w).
Proof.
  destruct w as [along_ h]. unfold is_within, lie_derivative_of. cbn [fst snd]. rewrite Bool.andb_true_iff. intros [F O].
  induction along_ as [|i along_ IH]; cbn [fold_right forallb] in *.
  - constructor. apply nth_In, Nat.ltb_lt, O.
  - apply Bool.andb_true_iff in F. destruct F as [I F]. constructor; [apply nth_In, Nat.ltb_lt, I|auto].
Qed.

Definition shows_observability_rank (p : place) (words : list word) conditions fields outputs unknowns : bool :=
  let es := map (lie_derivative_of fields outputs) words in
  all_met p conditions && forallb (is_within fields outputs) words && forallb (is_smooth_at p) es &&
  are_shown_independent p (differentials unknowns es).
Theorem observability_rank_reaches_correct p words conditions fields outputs unknowns r :
  shows_observability_rank p words conditions fields outputs unknowns && Nat.eqb (length words) r = true ->
  observability_rank_reaches conditions fields outputs unknowns r.
Proof.
  unfold shows_observability_rank. rewrite !Bool.andb_true_iff. intros [[[[C W] V] I] E].
  exists (state_at p), (map (lie_derivative_of fields outputs) words).
  split; [|rewrite map_length; apply Nat.eqb_eq, E]. split; [apply all_met_ok, C|]. split; [|split].
  - apply Forall_forall. intros e H. apply in_map_iff in H. destruct H as (w & <- & H). apply is_within_ok.
    rewrite forallb_forall in W. apply W, H.
  - eapply forallb_Forall; [|exact V]. apply smooth_at_ok.
  - apply are_shown_independent_ok, I.
Qed.
Theorem greatest_observability_rank_correct p words conditions fields outputs unknowns r :
  shows_observability_rank p words conditions fields outputs unknowns && Nat.eqb (length words) r &&
    Nat.leb (length unknowns) r = true ->
  greatest_observability_rank conditions fields outputs unknowns r.
Proof.
  intros H. apply Bool.andb_true_iff in H. destruct H as [H N]. split; [apply (observability_rank_reaches_correct _ _ _ _ _ _ _ H)|].
  intros x es (_ & _ & _ & I). apply Nat.leb_le in N.
  replace (length es) with (length (rows_at x (differentials unknowns es))) by (unfold rows_at, differentials; rewrite !map_length; reflexivity).
  apply independent_bounded; [|exact I]. apply Forall_forall. intros row R column C.
  unfold rows_at, differentials in R. rewrite map_map in R. apply in_map_iff in R. destruct R as (e & <- & _).
  apply nth_overflow. rewrite !map_length. lia.
Qed.

(** The proofs of one line: at a state, by some rows, or by some Lie derivatives. *)
Tactic Notation "rank_at" uconstr(p) uconstr(rows) :=
  match goal with
  | |- greatest_rank _ _ _ => apply (greatest_rank_correct p rows)
  | |- rank_reaches _ _ _ => apply (rank_reaches_correct p rows)
  end; vm_cast_no_check (eq_refl true).
Tactic Notation "observability_rank_at" uconstr(p) uconstr(words) :=
  match goal with
  | |- greatest_observability_rank _ _ _ _ _ => apply (greatest_observability_rank_correct p words)
  | |- observability_rank_reaches _ _ _ _ _ => apply (observability_rank_reaches_correct p words)
  end; vm_cast_no_check (eq_refl true).
